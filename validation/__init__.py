"""Every number printed in four papers beside ours: `python -m validation`, doc/validation.md."""
