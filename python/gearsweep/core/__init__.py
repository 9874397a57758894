"""Cases, studies and tables: what all other rooms of the package build on."""
