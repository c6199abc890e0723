"""The workloads, one file each, by family."""
