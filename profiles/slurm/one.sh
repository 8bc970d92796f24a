#!/bin/bash
# The whole run as one Slurm job, for what fits on one node: sbatch --wait profiles/slurm/one.sh
#SBATCH --job-name=visuohaptic
#SBATCH --cpus-per-task=2
#SBATCH --mem=4000
#SBATCH --time=60
snakemake --cores "$SLURM_CPUS_PER_TASK" "$@"
