"""The network of touches beside the fixed descriptors of `order_free`."""
