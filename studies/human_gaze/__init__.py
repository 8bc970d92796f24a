"""Recordings of where people looked on objects → how well the attention model predicts it."""
