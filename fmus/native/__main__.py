"""Write the layout headers of all kernels."""

from .headers import FOLDER, headers

for _name, _text in headers().items():
    (FOLDER / _name).write_text(_text, encoding="utf-8")
