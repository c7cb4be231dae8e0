"""Offsets of real shapes against shapely's buffer: `python -m tests.offsets --fonts FOLDER --icons FOLDER --count N`.

Each shape is offset by shares of the radius of its largest maximal disc. The reference is a flattening so fine, with buffers so
round, that it knows the area to a millionth of the domain's (`buffering`); what is held against it is told in `check`. Without
fonts, icons or files of domains the shapes are those of the repository; `make test` runs a short form.
"""
