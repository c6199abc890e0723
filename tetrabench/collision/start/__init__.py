"""What simulations start from: models of objects, their order in memory, their files, and what there is to say of them."""
