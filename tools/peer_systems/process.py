"""Processes and the processor time that they take."""
import ctypes
import os
import pathlib
import resource
import signal
import subprocess

PR_SET_CHILD_SUBREAPER = 36  # linux/prctl.h


class Failed(Exception):
    """A command did not do what it was to do; says why, in a line."""


def adopt_orphans():
    """Lets `measured` wait for processes that outlive the one that started them, as vitrum's for pictures does."""
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def output_of(*command, **options):
    """What the command prints on its standard output. Raises Failed."""
    try:
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    except OSError as error:
        raise Failed(f"{command[0]}: {error.strerror}") from error
    if done.returncode != 0:
        lines = (done.stderr.strip() or done.stdout.strip()).splitlines()
        raise Failed(f"{command[0]}: {lines[-1] if lines else f'exit code {done.returncode}'}")
    return done.stdout


def measured(command, log, environment=None, limit=1200):
    """CPU seconds, user and system, of the command and all that it starts; what it prints goes to the file `log`.
    Raises Failed."""
    def spent():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime

    before = spent()
    environment = {**os.environ, **(environment or {})}
    with open(log, "w") as file:
        child = subprocess.Popen([str(part) for part in command], env=environment, stdin=subprocess.DEVNULL,
                                 stdout=file, stderr=subprocess.STDOUT, start_new_session=True)
    try:
        code = child.wait(limit)
    except subprocess.TimeoutExpired:
        os.killpg(child.pid, signal.SIGKILL)
        child.wait()
        raise Failed(f"{command[0]} took more than {limit} s") from None
    try:
        while True:
            os.wait()
    except ChildProcessError:
        pass  # none is left
    if code != 0:
        lines = pathlib.Path(log).read_text(errors="replace").strip().splitlines()
        raise Failed(f"{command[0]} ended with {code}: {lines[-1] if lines else 'it printed nothing'}")
    return spent() - before
