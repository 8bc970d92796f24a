"""The accuracies that the paper reports, shown beside the accuracies of a run.

G. Rouhafzay and A.-M. Cretu, "A visuo-haptic framework for object recognition
inspired from human tactile perception", Proceedings 4(1):47, 2018, Table 1.
"""

from __future__ import annotations

PAPER = (
    "G. Rouhafzay and A.-M. Cretu, A visuo-haptic framework for object recognition inspired "
    "from human tactile perception, 2018"
)

PAPER_PIPELINE = "paper"
"""The pipeline that is compared with `TABLE_1`."""

TABLE_1 = {
    "k_nearest_neighbours": {"fixation": 0.8558, "random": 0.8494},
    "support_vector_machine": {"fixation": 0.9345, "random": 0.8614},
    "decision_tree": {"fixation": 0.7356, "random": 0.7163},
    "quadratic_discriminant": {"fixation": 0.9189, "random": 0.8428},
    "naive_bayes": {"fixation": 0.5668, "random": 0.5716},
}
"""Published share of sequences correctly classified, by classifier and strategy, in the table's order."""
