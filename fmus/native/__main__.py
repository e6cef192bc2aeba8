"""Write the headers that follow from declarations in Python."""

from .headers import FOLDER, headers
from .records import RECORDS_HEADER, records_header

for _name, _text in headers().items():
    (FOLDER / _name).write_text(_text, encoding="utf-8")
RECORDS_HEADER.write_text(records_header(), encoding="utf-8")
