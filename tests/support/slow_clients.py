"""Clients that hold up whoever waits for them."""
import contextlib
import threading


@contextlib.contextmanager
def dribbling(connections, every_s=0.5):
    """Meanwhile each of these sockets sends a byte now and then, whatever it is answered."""
    ended = threading.Event()

    def dribble():
        while not ended.wait(every_s):
            for connection in connections:
                try:
                    connection.sendall(b"a")
                except OSError:
                    pass  # the other side has had enough of it
    thread = threading.Thread(target=dribble)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
