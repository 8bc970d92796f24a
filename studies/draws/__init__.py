"""Study `draws`: twenty draws of random places in both pipelines."""
