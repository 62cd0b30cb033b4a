# Shadow maps with soft edges. One gnomon_algorithm() call a module.
