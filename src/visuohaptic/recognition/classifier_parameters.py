"""Settings of the classifiers."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from visuohaptic.base.section import Section


class ClassifierParameters(Section):
    """Settings of the classifiers.

    The defaults of the paper's five are scikit-learn's, because the paper names none. Pipeline `order_free` has fixed
    settings of its own (`order_free.SETTINGS`).
    """

    neighbours: int = Field(5, ge=1, description="Neighbours that vote (kNN)")
    svm_kernel: Literal["linear", "poly", "rbf"] = Field("rbf", description="Kernel (SVM)")
    svm_penalty: float = Field(1.0, gt=0, description="Penalty C of a margin violation (SVM)")
    tree_leaf_sequences: int = Field(
        1, ge=1, description="Fewest sequences in a leaf (decision tree)"
    )
    discriminant_shrinkage: Literal["ledoit_wolf"] | Annotated[float, Field(gt=0, le=1)] = Field(
        "ledoit_wolf",
        description="Shrinkage of the classes' covariances, `ledoit_wolf` or a number up to 1 (quadratic discriminant)",
    )
    discriminant_regularisation: Literal["where_singular", "always", "pseudo_inverse"] = Field(
        "where_singular",
        description="Whether covariances are shrunk only `where_singular`, which the score's note then "
        "says, or `always`; `pseudo_inverse` shrinks none and leaves out directions without variance, "
        "as Matlab's `pseudoquadratic` does (quadratic discriminant)",
    )
    discriminant_target: Literal["own_variances", "mean_variance"] = Field(
        "own_variances",
        description="What a covariance is shrunk towards: uncorrelated features of their "
        "`own_variances`, or all of the `mean_variance` (quadratic discriminant)",
    )
    linear_shrinkage: Literal["auto"] | Annotated[float, Field(gt=0, le=1)] = Field(
        0.1,
        description="Shrinkage of the common covariance, `auto` by Ledoit and Wolf, or a number up to 1 "
        "(linear discriminant)",
    )
    logistic_penalty: float = Field(
        0.1, gt=0, description="Inverse strength of the penalty (logistic regression)"
    )
    bayes_smoothing: float = Field(
        1e-9, gt=0, description="Share of the largest variance added to each (naive Bayes)"
    )
