"""The numbers that four papers print beside ours: `python -m validation`, doc/validation.md."""
