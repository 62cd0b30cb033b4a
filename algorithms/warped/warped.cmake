# Shadow maps whose projection or texels follow the view. One gnomon_algorithm() call a module.
