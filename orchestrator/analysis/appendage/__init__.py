"""A wing as attitude control sees it: a linear appendage of the spacecraft, and the files that hand it on."""
