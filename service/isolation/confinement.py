"""What a worker gives up before it runs a user's shader: root, files, other programs, the network.

The driver turns the shader into machine code in this very process, and plain GLSL can make it touch memory that is not
its own. So the process is left with what computing takes: memory, threads, a clock, and the pipes it already has. The
kernel refuses every other system call (seccomp, https://docs.kernel.org/userspace-api/seccomp_filter.html).
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import platform
import resource
import signal
import struct
from pathlib import Path

NOBODY = 65534

_PR_SET_PDEATHSIG, _PR_SET_NAME, _PR_SET_NO_NEW_PRIVS = 1, 15, 38
_SYS_SECCOMP, _SET_MODE_FILTER, _ALL_THREADS = 317, 1, 1
_ARCHITECTURE = 0xC000003E  # AUDIT_ARCH_X86_64
_CLONE_THREAD = 0x10000
_EPERM, _ENOSYS = 1, 38

# linux/arch/x86/entry/syscalls/syscall_64.tbl
_ALLOWED = {
    "read": 0, "write": 1, "close": 3, "fstat": 5, "poll": 7, "lseek": 8, "mmap": 9, "mprotect": 10, "munmap": 11,
    "brk": 12, "rt_sigaction": 13, "rt_sigprocmask": 14, "rt_sigreturn": 15, "readv": 19, "writev": 20, "select": 23,
    "sched_yield": 24, "mremap": 25, "msync": 26, "madvise": 28, "dup": 32, "nanosleep": 35, "getpid": 39, "exit": 60,
    "uname": 63, "fcntl": 72, "ftruncate": 77, "gettimeofday": 96, "getrlimit": 97, "getrusage": 98, "sysinfo": 99,
    "times": 100, "getuid": 102, "getgid": 104, "geteuid": 107, "getegid": 108, "sigaltstack": 131,
    "sched_setscheduler": 144, "sched_getscheduler": 145, "arch_prctl": 158, "gettid": 186, "time": 201, "futex": 202,
    "sched_setaffinity": 203, "sched_getaffinity": 204, "set_tid_address": 218, "restart_syscall": 219,
    "clock_gettime": 228, "clock_getres": 229, "clock_nanosleep": 230, "exit_group": 231, "ppoll": 271,
    "set_robust_list": 273, "fallocate": 285, "eventfd2": 290, "getcpu": 309, "getrandom": 318, "memfd_create": 319,
    "membarrier": 324, "rseq": 334,
}  # fmt: skip
_CLONE, _PRCTL, _TGKILL, _PRLIMIT, _CLONE3 = 56, 157, 234, 302, 435


class CannotConfine(OSError):
    """This machine has no filter of system calls for the process, or the right to change its user is missing."""


def limit(memory_bytes: int) -> None:
    """Bound what this process may take, and let it be the first to go where the machine's memory runs out."""
    with contextlib.suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("1000")
    for kind, wanted in (
        (resource.RLIMIT_AS, memory_bytes),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_FSIZE, 1 << 28),
    ):
        _, hard = resource.getrlimit(kind)
        bound = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
        resource.setrlimit(kind, (bound, bound))


def become_unprivileged() -> None:
    """Become the user nobody where this process is root, end with its parent, and gain no rights by programs it starts.

    Raises CannotConfine.
    """
    if os.geteuid() == 0:
        try:
            os.setgroups([])
            os.setresgid(NOBODY, NOBODY, NOBODY)
            os.setresuid(NOBODY, NOBODY, NOBODY)
        except OSError as error:
            raise CannotConfine(error.errno, f"cannot give up root: {error.strerror}") from None
    prctl = ctypes.CDLL(None).prctl
    # After the change of user, which takes the first of these back.
    prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)


def allow_computing_only() -> None:
    """Refuse from now on, in every thread of this process, all system calls but those of computing (EPERM).

    Pipes that are open stay usable. There is no way back. Raises CannotConfine where the kernel has no such filter, or
    the machine is no x86-64.
    """
    if platform.machine() != "x86_64":
        raise CannotConfine(_ENOSYS, f"no filter of system calls for {platform.machine()}")
    program = _filter(os.getpid())
    libc = ctypes.CDLL(None, use_errno=True)
    code = ctypes.create_string_buffer(program)
    # struct sock_fprog: the number of instructions, padding, their address.
    head = ctypes.create_string_buffer(struct.pack("@HxxxxxxQ", len(program) // 8, ctypes.addressof(code)))
    if libc.syscall(_SYS_SECCOMP, _SET_MODE_FILTER, _ALL_THREADS, head) != 0:
        number = ctypes.get_errno()
        raise CannotConfine(number, f"no filter of system calls: {os.strerror(number)}")


def _filter(pid: int) -> bytes:
    """The filter as classic BPF over struct seccomp_data: number at 0, architecture at 4, arguments from 16 on."""
    load, equal, at_least, any_bit, answer = 0x20, 0x15, 0x35, 0x45, 0x06
    allow, refuse, missing, kill = 0x7FFF0000, 0x00050000 | _EPERM, 0x00050000 | _ENOSYS, 0x80000000

    def step(code: int, value: int, yes: int = 0, no: int = 0) -> bytes:
        return struct.pack("<HBBI", code, yes, no, value)

    def only_where(call: int, argument: int, test: int, value: int) -> list[bytes]:
        """Allow a call where its argument passes a test."""
        return [
            step(equal, call, 0, 4),
            step(load, 16 + 8 * argument),
            step(test, value, 0, 1),
            step(answer, allow),
            step(answer, refuse),
        ]

    steps = [
        step(load, 4),
        step(equal, _ARCHITECTURE, 1),
        step(answer, kill),
        step(load, 0),
        step(at_least, 0x40000000, 0, 1),  # the x32 calls, numbered from there
        step(answer, refuse),
        # A thread is a clone with this flag; without it, it would be a process. glibc takes clone where clone3 is not.
        *only_where(_CLONE, 0, any_bit, _CLONE_THREAD),
        step(equal, _CLONE3, 0, 1),
        step(answer, missing),
        *only_where(_PRCTL, 0, equal, _PR_SET_NAME),
        *only_where(_TGKILL, 0, equal, pid),  # abort() of itself
        *only_where(_PRLIMIT, 0, equal, 0),  # of itself
    ]
    for number in sorted(_ALLOWED.values()):
        steps += [step(equal, number, 0, 1), step(answer, allow)]
    return b"".join([*steps, step(answer, refuse)])
