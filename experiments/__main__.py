"""`imitate` and `python -m experiments`: the frame of `experiments.command_line`, whatever becomes of it.

Exit statuses: 0; 2 for what the user can mend, with one line on standard error; 129, 130 or 143 when told to stop by
SIGHUP, SIGINT (Ctrl-C) or SIGTERM; 141, without a word, when nobody reads standard output any more (`| head -1`). When
it cannot be written otherwise (a full disk) that is 2: files and folders that were written by then stand.
"""

import os
import sys

try:
    from experiments import stopping
except KeyboardInterrupt:  # so soon
    os._exit(130)


def main(arguments: list[str] | None = None) -> int:
    """Do what the words ask; the exit status. None are this process's, whose signals and streams are minded then."""
    ours = arguments is None
    if ours:
        stopping.attend()
        streams()
    try:
        from experiments.command_line import obey

        status = obey(sys.argv[1:] if arguments is None else arguments)
        sys.stdout.flush()
    except BaseException as error:
        status = last_words(error)
    if ours:
        stopping.deaf()
        try:
            sys.stdout.flush()
        except OSError:  # or Python would try again, and exit with a status of its own
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    return status


def last_words(error: BaseException) -> int:
    """Say in a line what ended it; the exit status. Our own faults are raised again."""
    if isinstance(error, KeyboardInterrupt) or stopping.stopped():
        stopping.say(stopping.WORDS)
        return 128 + (stopping.stopped() or 2)
    if isinstance(error, BrokenPipeError) or isinstance(error.__context__, BrokenPipeError):  # rich makes an exit of it
        return 141
    if isinstance(error, OSError):
        what = f"{error.filename}: cannot be read or" if error.filename else "standard output, or a file: cannot be"
        stopping.say(f"{what} written ({error.strerror or error}); what was written before stands")
        return 2
    raise error


def streams() -> None:
    """Standard streams that are open, and that print letters they do not have as question marks."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    sys.stdout = sys.stdout or open(os.devnull, "w")
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")


def script(package: str | None) -> None:
    """Run the experiment that this package is, with the words of the command line (`python -m experiments.NAME`)."""
    sys.argv[1:1] = [str(package).rpartition(".")[2]]
    sys.exit(main())


if __name__ == "__main__":
    sys.exit(main())
