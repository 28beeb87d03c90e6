"""The only place that advances time: plan, world, process and stock, window by window."""
