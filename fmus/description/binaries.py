"""Where an FMU has its binary for the platform that this is."""

from __future__ import annotations

from fmpy import platform, platform_tuple, sharedLibraryExtension


def folder_here(version: str) -> str:
    """Folder of binaries for this platform in an FMU of a version of FMI."""
    return str(platform if version.startswith("2.") else platform_tuple)


def binary_member(version: str, identifier: str) -> str:
    """The binary for this platform of a model identifier, as a member of the archive."""
    return f"binaries/{folder_here(version)}/{identifier}{sharedLibraryExtension}"
