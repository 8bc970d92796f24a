"""Settings of pipeline `order_free`, chosen on objects that report nothing."""
