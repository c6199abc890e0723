"""The half-face kernel: a tetrahedral mesh in 32 bytes a tetra, with local queries that cost the same in any mesh."""
