"""Where the kernel cannot confine the helper that decodes meshes: a seccomp filter
stands for such a kernel. What the sandbox keeps out where there is one is in
decode_test and test_bad_input."""

import ctypes
import errno
import subprocess

import requests

import meshes
from live_server import LiveServer

ALLOW = 0x7FFF0000
ERRNO_ENOSYS = 0x00050000 | errno.ENOSYS
PR_SET_SECCOMP = 22


class Compare(ctypes.Structure):
    """libseccomp's scmp_arg_cmp: argument 0 equals a."""
    _fields_ = [("arg", ctypes.c_uint), ("op", ctypes.c_int),
                ("a", ctypes.c_uint64), ("b", ctypes.c_uint64)]


def take_seccomp_away():
    """From this process and all that it starts; run between fork and exec."""
    library = ctypes.CDLL("libseccomp.so.2")
    library.seccomp_init.restype = ctypes.c_void_p
    rules = ctypes.c_void_p(library.seccomp_init(ctypes.c_uint32(ALLOW)))
    by_name = library.seccomp_syscall_resolve_name
    equal = 4
    failed = library.seccomp_rule_add(rules, ctypes.c_uint32(ERRNO_ENOSYS),
                                      by_name(b"seccomp"), ctypes.c_uint(0))
    failed |= library.seccomp_rule_add_array(
        rules, ctypes.c_uint32(ERRNO_ENOSYS), by_name(b"prctl"), ctypes.c_uint(1),
        ctypes.byref(Compare(0, equal, PR_SET_SECCOMP, 0)))
    failed |= library.seccomp_load(rules)
    if failed:
        raise OSError("the filter cannot be loaded")


def test_a_server_that_cannot_confine_its_helper_refuses_to_start(binary, tmp_path):
    ended = subprocess.run([binary, "serve", "--db", str(tmp_path / "a.db"), "--port", "0"],
                           preexec_fn=take_seccomp_away, capture_output=True, text=True,
                           timeout=60)
    assert ended.returncode == 2, ended.stderr
    assert "seccomp" in ended.stderr and "--allow-unsandboxed" in ended.stderr
    assert "Traceback" not in ended.stderr and ended.stdout == ""


def test_told_otherwise_it_says_that_nothing_confines_the_helper(binary, tmp_path):
    live = LiveServer(binary, tmp_path / "a.db", tmp_path, "--allow-unsandboxed",
                      preexec_fn=take_seccomp_away)
    assert "confined by none" in live.log()
    answer = requests.post(live.url + "/v1/objects?format=obj",
                           data=meshes.box_obj(0.1, 0.1, 0.1), timeout=60)
    assert answer.status_code == 201, answer.text
    assert live.stop() == 0


def test_where_there_is_a_sandbox_the_flag_changes_nothing(binary, tmp_path):
    live = LiveServer(binary, tmp_path / "a.db", tmp_path, "--allow-unsandboxed")
    assert "seccomp" in live.log()
    assert live.stop() == 0
