# SPDX-License-Identifier: GPL-3.0-or-later
"""What an HDF5 file must be before its values are read: all of it in the one file (as lib/hdf5/file_screening.h has it)."""
import h5py


class ForeignFileError(OSError):
    """The file leads to another one."""


def require_self_contained(file):
    """Raises ForeignFileError, naming the path within, for a link that is not hard, a virtual dataset and external values.

    Follows no link and reads no value, so that no other file is opened.
    """
    groups, seen = [file["/"]], {_address(file["/"])}
    while groups:
        group = groups.pop()
        for name in group:
            path = f"{group.name.rstrip('/')}/{name}"
            link = group.get(name, getlink=True)
            if not isinstance(link, h5py.HardLink):
                target = f"{getattr(link, 'filename', '')} {getattr(link, 'path', '')}".strip()
                raise ForeignFileError(f"{path} is a link, to {target or 'what only other programs know'}; links are not followed")
            item = group[name]
            if isinstance(item, h5py.Dataset) and (item.is_virtual or item.external):
                raise ForeignFileError(f"{path} keeps its values in other files, which are not opened")
            if isinstance(item, h5py.Group) and _address(item) not in seen:
                seen.add(_address(item))
                groups.append(item)


def _address(item):
    return h5py.h5o.get_info(item.id).addr
