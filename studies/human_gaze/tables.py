"""The table of agreement of predictions with people's gaze."""

from __future__ import annotations

import pyarrow as pa

from visuohaptic.tables.schema import REAL, TEXT, Column, Schema

AGREEMENT = Schema(
    "gaze",
    (
        Column("object", TEXT, "name of the recorded object"),
        Column("predictor", TEXT, "what predicts where people look"),
    ),
    (
        Column("part", TEXT, "training: weights were fitted without the object's fold; test: on training"),
        Column("correlation", REAL, "Pearson's correlation over the seen area (CC)", "1", -1.0001, 1.0001),
        Column("auc_top", REAL, "area under the curve, most looked at fifth against the rest", "1", 0, 1.0001),
        Column("auc_gaze", REAL, "area under the curve, by time against by area (Judd)", "1", 0, 1.0001),
        Column("normalised_saliency", REAL, "mean where people looked, in deviations (NSS)", "1"),
        Column("divergence", REAL, "Kullback-Leibler divergence (KL)", "nats", -0.001),
        Column("similarity", REAL, "time that prediction and people share (SIM)", "1", 0, 1.0001),
        Column("alignment_error", REAL, "distance off the mesh within which 95 % of the points lie", "object radii", 0),
        Column("reconstructed", pa.bool_(), "whether the surface was made from the recorded points"),
        Column("gaze_seconds", REAL, "time that people looked at the object", "s", 0),
        Column("seen_share", REAL, "share of that time on what a viewpoint sees", "1", 0, 1.0001),
        Column("digest", TEXT, "SHA-256 of the recording"),
    ),
)  # fmt: skip
