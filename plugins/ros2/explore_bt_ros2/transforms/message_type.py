"""The type ``tf2_msgs/msg/TFMessage``, with a full ROS 2 and without.

The wheels on the package index hold no ``tf2_msgs``, and building it takes a compiler. But a topic whose
messages go in and out as bytes needs no more of its type than name, fields and hash: the description that the
middleware asks for is made here from that of another message of unbounded size, with name and field changed.
``rmw_fastrtps`` calls the conversions of a type only for messages that are not bytes, so they are never
called. See ``docs/decisions/ros2.md``.
"""

from __future__ import annotations

import ctypes
import importlib.util
from typing import Any

__all__ = ["tf_message_type"]

_FASTRTPS_C = b"rosidl_typesupport_fastrtps_c"
_INTROSPECTION_C = b"rosidl_typesupport_introspection_c"
_HASH = bytes.fromhex("e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087")
"""REP-2011 hash of TFMessage's fields (RIHS01): the same as of the ``tf2_msgs`` that ROS 2 Jazzy ships."""
_NAMESPACE, _NAME = b"tf2_msgs__msg", b"TFMessage"


class _Handle(ctypes.Structure):
    """``rosidl_message_type_support_t``."""

    _fields_ = (
        ("identifier", ctypes.c_char_p),
        ("data", ctypes.c_void_p),
        ("find", ctypes.c_void_p),
        ("hash", ctypes.c_void_p),
        ("description", ctypes.c_void_p),
        ("sources", ctypes.c_void_p),
    )


class _Callbacks(ctypes.Structure):
    """``message_type_support_callbacks_t`` of ``rosidl_typesupport_fastrtps_cpp``."""

    _fields_ = (
        ("namespace", ctypes.c_char_p),
        ("name", ctypes.c_char_p),
        ("serialize", ctypes.c_void_p),
        ("deserialize", ctypes.c_void_p),
        ("size", ctypes.c_void_p),
        ("max_size", ctypes.c_void_p),
        ("key", ctypes.c_void_p),
    )


class _Member(ctypes.Structure):
    """``rosidl_typesupport_introspection_c__MessageMember``: a field."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("type_id", ctypes.c_uint8),
        ("string_upper_bound", ctypes.c_size_t),
        ("members", ctypes.c_void_p),
        ("is_key", ctypes.c_bool),
        ("is_array", ctypes.c_bool),
        ("array_size", ctypes.c_size_t),
        ("is_upper_bound", ctypes.c_bool),
        ("offset", ctypes.c_uint32),
        ("default", ctypes.c_void_p),
        ("functions", ctypes.c_void_p * 6),
    )


class _Members(ctypes.Structure):
    """``rosidl_typesupport_introspection_c__MessageMembers``: a message's fields."""

    _fields_ = (
        ("namespace", ctypes.c_char_p),
        ("name", ctypes.c_char_p),
        ("count", ctypes.c_uint32),
        ("size", ctypes.c_size_t),
        ("has_key", ctypes.c_bool),
        ("members", ctypes.POINTER(_Member)),
        ("begin", ctypes.c_void_p),
        ("end", ctypes.c_void_p),
    )


class _TypeHash(ctypes.Structure):
    """``rosidl_type_hash_t``."""

    _fields_ = (("version", ctypes.c_uint8), ("value", ctypes.c_uint8 * 32))


_FindHandle = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_char_p)
_FindHash = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)


def tf_message_type() -> Any:
    """The message class, good for subscriptions with ``raw=True`` and for publishing bytes.

    Raises:
        ImportError: the middleware is not Fast DDS, and ``tf2_msgs`` is not installed.
    """
    if importlib.util.find_spec("tf2_msgs") is not None:
        from tf2_msgs.msg import TFMessage

        return TFMessage
    return _borrowed()


def _borrowed() -> Any:
    from geometry_msgs.msg import PoseArray, TransformStamped

    lender, element = (_with_support(type(kind)) for kind in (PoseArray, TransformStamped))
    type_hash = _TypeHash(1, (ctypes.c_uint8 * 32)(*_HASH))
    find_hash = _FindHash(lambda _: ctypes.addressof(type_hash))
    hash_address = ctypes.cast(find_hash, ctypes.c_void_p).value

    wire = _copy_of(_found(lender, _FASTRTPS_C), hash_address)
    callbacks = _Callbacks.from_buffer_copy(_Callbacks.from_address(wire.data))
    callbacks.namespace, callbacks.name = _NAMESPACE.replace(b"__", b"::"), _NAME
    wire.data = ctypes.addressof(callbacks)

    described = _copy_of(_found(lender, _INTROSPECTION_C), hash_address)
    members = _Members.from_buffer_copy(_Members.from_address(described.data))
    field = _Member.from_buffer_copy(members.members[members.count - 1])  # PoseArray's array of poses
    field.name, field.members = b"transforms", ctypes.addressof(_found(element, _INTROSPECTION_C))
    members.namespace, members.name, members.count = _NAMESPACE, _NAME, 1
    members.members = ctypes.pointer(field)
    described.data = ctypes.addressof(members)

    by_name = {_FASTRTPS_C: ctypes.addressof(wire), _INTROSPECTION_C: ctypes.addressof(described)}
    find = _FindHandle(lambda _, identifier: by_name.get(identifier))
    whole = _copy_of(_Handle.from_address(_address(lender._TYPE_SUPPORT)), hash_address)
    whole.find = ctypes.cast(find, ctypes.c_void_p).value

    class Meta(type):
        """What rclpy looks for in a message's class."""

        _TYPE_SUPPORT = _capsule(ctypes.addressof(whole))
        _CREATE_ROS_MESSAGE = lender._CREATE_ROS_MESSAGE
        _CONVERT_FROM_PY = lender._CONVERT_FROM_PY
        _CONVERT_TO_PY = lender._CONVERT_TO_PY
        _DESTROY_ROS_MESSAGE = lender._DESTROY_ROS_MESSAGE
        _kept = (whole, wire, callbacks, described, members, field, type_hash, find_hash, find)
        """The middleware holds their addresses."""

    return Meta("TFMessage", (), {"__module__": "tf2_msgs.msg"})


def _with_support(meta: Any) -> Any:
    if meta._TYPE_SUPPORT is None:
        meta.__import_type_support__()
    return meta


def _found(meta: Any, identifier: bytes) -> _Handle:
    """A message's handle for one kind of support."""
    handle = _Handle.from_address(_address(meta._TYPE_SUPPORT))
    address = _FindHandle(handle.find)(ctypes.addressof(handle), identifier)
    if not address:
        raise ImportError(
            f"{identifier.decode()} is not installed: without it only an installed tf2_msgs lets /tf be read"
        )
    return _Handle.from_address(address)


def _copy_of(handle: _Handle, hash_address: int | None) -> _Handle:
    copy = _Handle.from_buffer_copy(handle)
    copy.hash = hash_address
    return copy


def _address(capsule: object) -> int:
    get = ctypes.pythonapi.PyCapsule_GetPointer
    get.restype, get.argtypes = ctypes.c_void_p, (ctypes.py_object, ctypes.c_char_p)
    return int(get(capsule, None))


def _capsule(address: int) -> object:
    make = ctypes.pythonapi.PyCapsule_New
    make.restype, make.argtypes = ctypes.py_object, (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)
    return make(address, None, None)
