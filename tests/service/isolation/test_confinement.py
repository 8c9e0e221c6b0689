"""What a worker may still do when it is confined: compute, and nothing else. Each attempt is made in a process of its
own, that gives up its rights as the worker does.
"""

import json
import os
import platform
import subprocess
import sys
import textwrap

import pytest

PROLOGUE = """
import ctypes, errno, json, os, signal, socket, subprocess, sys, threading
from service.isolation import confinement
libc = ctypes.CDLL(None, use_errno=True)
def tried(attempt):
    try:
        return attempt()
    except OSError as error:
        return errno.errorcode[error.errno]
def call(*arguments):
    return "ok" if libc.syscall(*arguments) >= 0 else errno.errorcode[ctypes.get_errno()]
"""


def run(code):
    """What a Python process prints as JSON."""
    command = [sys.executable, "-c", PROLOGUE + textwrap.dedent(code)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.skipif(platform.machine() != "x86_64", reason="the filter knows the numbers of x86-64")
def test_files_programs_processes_signals_and_the_network_are_refused():
    outcomes = run(
        """
        other = subprocess.Popen(["sleep", "600"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        confinement.allow_computing_only()
        X32 = 0x40000000
        outcomes = {
            "open to read": tried(lambda: os.open("/etc/hostname", os.O_RDONLY)),
            "open to write": tried(lambda: os.open("/tmp/confined", os.O_WRONLY | os.O_CREAT)),
            "openat2": call(437, -100, b"/etc/hostname", None, 0),
            "list": tried(lambda: os.listdir("/")),
            "unlink": tried(lambda: os.unlink("/tmp/confined")),
            "rename": tried(lambda: os.rename("/tmp/a", "/tmp/b")),
            "readlink": tried(lambda: os.readlink("/proc/self/exe")),
            "socket": tried(lambda: socket.socket()),
            "socketpair": tried(lambda: socket.socketpair()),
            "exec": tried(lambda: os.execv("/bin/true", ["true"])),
            "fork": tried(os.fork),
            "kill": tried(lambda: os.kill(other.pid, signal.SIGKILL)),
            "tgkill": call(234, other.pid, other.pid, 9),
            "ptrace": call(101, 16, other.pid, 0, 0),
            "limits of another": call(302, other.pid, 7, None, None),
            "mount": call(165, b"none", b"/tmp", b"tmpfs", 0, None),
            "unshare": call(272, 0x20000),
            "io_uring": call(425, 1, None),
            "bpf": call(321, 0, None, 0),
            "open by the x32 number": call(X32 + 2, b"/etc/hostname", 0),
            "another filter": call(317, 1, 0, None),
            "dumpable": call(157, 4, 1, 0, 0, 0),
        }
        print(json.dumps([outcomes, other.pid]))
        """
    )
    refused, other = outcomes
    os.kill(other, 9)  # alive until now
    assert refused == dict.fromkeys(refused, "EPERM")
    assert not os.path.exists("/tmp/confined")


@pytest.mark.skipif(platform.machine() != "x86_64", reason="the filter knows the numbers of x86-64")
def test_memory_threads_and_open_pipes_still_work_and_threads_that_ran_before_are_confined_too():
    found = run(
        """
        go, said = threading.Event(), []
        def early():
            go.wait()
            said.append(tried(lambda: os.open("/etc/hostname", os.O_RDONLY)))
        before = threading.Thread(target=early)
        before.start()
        reading, writing = os.pipe()
        confinement.allow_computing_only()
        go.set()
        before.join()
        after = threading.Thread(target=lambda: said.append(len(bytearray(64 << 20))))
        after.start()
        after.join()
        os.write(writing, b"through")
        said.append(os.read(reading, 7).decode())
        print(json.dumps(said))
        """
    )
    assert found == ["EPERM", 64 << 20, "through"]


def test_an_abort_still_ends_the_process():
    command = [sys.executable, "-c", PROLOGUE + "confinement.allow_computing_only(); os.abort()"]
    done = subprocess.run(command, capture_output=True, timeout=60, check=False)
    assert done.returncode == -6


@pytest.mark.skipif(os.geteuid() != 0, reason="only root has something to give up")
def test_root_is_given_up_for_good():
    found = run(
        """
        os.setgroups([0, 10])
        confinement.become_unprivileged()
        print(json.dumps([os.getresuid(), os.getresgid(), os.getgroups(), tried(lambda: os.setuid(0)),
                          open("/proc/self/status").read().split("NoNewPrivs:")[1].split()[0],
                          open("/proc/self/status").read().split("CapEff:")[1].split()[0]]))
        """
    )
    assert found == [[65534] * 3, [65534] * 3, [], "EPERM", "1", "0" * 16]


def test_memory_is_bounded_and_the_process_is_the_first_to_go_where_it_runs_out():
    found = run(
        """
        confinement.limit(1 << 30)
        first = open("/proc/self/oom_score_adj").read().strip()
        try:
            bytearray(2 << 30)
            print(json.dumps(["allocated", first]))
        except MemoryError:
            print(json.dumps(["refused", first]))
        """
    )
    assert found == ["refused", "1000"]
