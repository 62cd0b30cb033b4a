# Install rules are added with the library target.
