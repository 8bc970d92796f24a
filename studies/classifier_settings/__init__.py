"""Choose the settings of pipeline `order_free` on objects that no result reports."""
