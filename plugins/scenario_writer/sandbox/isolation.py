"""The walls around a script: own namespaces, an empty root folder, resource limits, a system call filter.

Runs in the sandbox's process only, before any line of the script is read. Each wall alone stops most of what
a script may try; `inside` says which of them stand. Linux; elsewhere only the resource limits. Knows no script.
"""

from __future__ import annotations

import ctypes
import os
import platform
import resource
import signal
import struct
import sys
from collections.abc import Mapping, Sequence

NEW_NS, NEW_UTS, NEW_IPC, NEW_USER, NEW_PID, NEW_NET = (
    0x20000, 0x4000000, 0x8000000, 0x10000000, 0x20000000, 0x40000000,
)  # fmt: skip
_ISOLATED = NEW_NS | NEW_UTS | NEW_IPC | NEW_PID | NEW_NET
_PDEATHSIG, _NO_NEW_PRIVS, _SECCOMP, _FILTER = 1, 38, 22, 2
_ERRNO_EPERM, _ALLOW, _KILL = 0x00050001, 0x7FFF0000, 0x80000000
_ARCHITECTURES: Mapping[str, tuple[int, frozenset[int]]] = {
    # read write close fstat lseek mmap mprotect munmap brk sigaction sigprocmask sigreturn mremap madvise getpid
    # exit getcwd getrusage sigaltstack gettid futex clock_gettime clock_nanosleep exit_group getrandom
    # newfstatat (answers for open descriptors; the root is empty) rseq
    "x86_64": (0xC000003E, frozenset((
        0, 1, 3, 5, 8, 9, 10, 11, 12, 13, 14, 15, 25, 28, 39, 60, 79, 98, 131, 186, 202, 228, 230, 231, 318, 262, 334,
    ))),
    "aarch64": (0xC00000B7, frozenset((
        63, 64, 57, 80, 62, 222, 226, 215, 214, 134, 135, 139, 216, 233, 172, 93, 17, 165, 132, 178, 98, 113, 115, 94,
        278, 79, 293,
    ))),
}  # fmt: skip

_WAIT4 = {"x86_64": 61, "aarch64": 260}


def isolate(channels: Sequence[int]) -> bool:
    """Continues in new namespaces, without network; False if the system does not allow it.

    The caller's process waits without the `channels` (descriptors) and ends as its child ends: by exit code, 128 +
    signal for a death. So does process 1, whose end also ends all others of its namespace (and which no limit's signal
    would end).
    """
    if not sys.platform.startswith("linux"):
        return False
    libc = _libc()
    libc.prctl(_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if libc.unshare(NEW_USER | _ISOLATED) != 0 and libc.unshare(_ISOLATED) != 0:
        return False
    for _ in ("process 1", "the script's"):
        if child := os.fork():
            _end_like(child, channels)
        libc.prctl(_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    return True


def _end_like(child: int, channels: Sequence[int]) -> None:
    for channel in channels:
        os.close(channel)
    status = os.waitpid(child, 0)[1]
    os._exit(128 + os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status))


def split() -> int:
    """Goes on in two processes, of which the second ends with the first; as `os.fork` says which one this is."""
    child = os.fork()
    if not child and sys.platform.startswith("linux"):
        _libc().prctl(_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    return child


def shut_in(folder: str) -> bool:
    """Makes an empty folder the root of all paths; False if the system does not allow it."""
    try:
        os.chroot(folder)
    except (OSError, AttributeError):
        return False
    os.chdir("/")
    return True


def limit(cpu_s: int, memory_mb: int) -> None:
    """Sets resource limits: processor seconds, address space; no files, no processes, no core dumps."""
    memory = memory_mb << 20
    for what, soft, hard in (
        (resource.RLIMIT_CPU, cpu_s, cpu_s + 1),
        (resource.RLIMIT_AS, memory, memory),
        (resource.RLIMIT_FSIZE, 0, 0),
        (resource.RLIMIT_CORE, 0, 0),
        (resource.RLIMIT_NOFILE, 8, 8),
        (resource.RLIMIT_NPROC, 0, 0),
    ):
        resource.setrlimit(what, (soft, hard))


def filter_calls(*, waits: bool = False) -> bool:
    """Allows only system calls that compute; all others answer EPERM. False if there is no filter for this machine.

    `waits`: and that which waits for a child.
    """
    known = _ARCHITECTURES.get(platform.machine()) if sys.platform.startswith("linux") else None
    if known is None:
        return False
    libc, code = _libc(), _program(known[0], known[1] | ({_WAIT4[platform.machine()]} if waits else set()))
    buffer = ctypes.create_string_buffer(code, len(code))
    program = struct.pack("HxxxxxxP", len(code) // 8, ctypes.addressof(buffer))
    if libc.prctl(_NO_NEW_PRIVS, 1, 0, 0, 0) != 0:
        return False
    return bool(libc.prctl(_SECCOMP, _FILTER, ctypes.create_string_buffer(program, len(program)), 0, 0) == 0)


def _program(architecture: int, allowed: frozenset[int]) -> bytes:
    """A BPF program: kill on another architecture, allow the listed calls, EPERM for the rest."""
    load, equal, give = 0x20, 0x15, 0x06
    lines = [(load, 0, 0, 4), (equal, 1, 0, architecture), (give, 0, 0, _KILL), (load, 0, 0, 0)]
    numbers = sorted(allowed)
    lines += [(equal, len(numbers) - i, 0, number) for i, number in enumerate(numbers)]
    lines += [(give, 0, 0, _ERRNO_EPERM), (give, 0, 0, _ALLOW)]
    return b"".join(struct.pack("HBBI", *line) for line in lines)


def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)
