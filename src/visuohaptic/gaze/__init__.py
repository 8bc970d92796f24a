"""Gaze: recordings of where people looked on objects → how well attention predicts it."""
