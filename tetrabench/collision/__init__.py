"""The collision family: which of many moving circles touch. The interface of its structures, and the dynamics, once."""
