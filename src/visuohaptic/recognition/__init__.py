"""Classify objects from sequences of touches: pipelines, protocols, predictions and saved models."""

import lazy_loader

# Loaded on first use: parameters are read without scikit-learn, which takes a second to import.
__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "descriptors": ["touch_descriptors"],
        "encoding": ["SequenceEncoder"],
        "experiment": ["run_pipeline"],
        "maps": ["FeatureGroups"],
        "model": ["RecognitionModel", "fit_model"],
        "parameters": ["RecognitionParameters"],
        "pipelines": ["make_order_free"],
        "splits": ["GroupedFolds", "LeaveOneObjectPerClassOut", "ViewpointFolds"],
        "stored_models": ["load_model", "save_model"],
        "touch_arrays": ["flatten_touches", "touch_arrays"],
    },
)
