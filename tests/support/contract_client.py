"""A connection that sends requests as they are, odd ones too, and reads what comes back."""
import http.client
import socket

from contract import Exchange

STREAM = "text/event-stream"


class Client:
    def __init__(self, port, timeout_s=30):
        self.port, self.timeout_s = port, timeout_s
        self.connection = None

    def close(self):
        if self.connection:
            self.connection.close()
        self.connection = None

    def exchange(self, method, path, headers=(), body=None, alone=False):
        """-> Exchange; None where there was no answer to a request that says something else of its body than it has.
        `alone`: on a connection of its own, because nobody knows where the next request would begin."""
        if alone:
            self.close()
        for attempt in (1, 2):
            is_old = self.connection is not None
            try:
                return self.once(method, path, headers, body, alone)
            except socket.timeout:
                self.close()
                if alone:
                    return None
                raise
            except (http.client.HTTPException, OSError):
                # A server may close a connection that waits, just when the next request is sent.
                self.close()
                if alone and not is_old:
                    return None
                if not is_old or attempt == 2:
                    raise
        return None

    def once(self, method, path, headers, body, alone):
        if not self.connection:
            self.connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=3 if alone else self.timeout_s)
        names = {name.lower() for name, _ in headers}
        self.connection.putrequest(method, path, skip_host="host" in names, skip_accept_encoding=True)
        for name, value in headers:
            self.connection.putheader(name, value.encode("utf-8", "surrogatepass"))
        if "content-length" not in names and (body is not None or method in ("POST", "PUT", "PATCH")):
            self.connection.putheader("Content-Length", str(len(body or b"")))
        try:
            self.connection.endheaders(body)
        except (BrokenPipeError, ConnectionResetError):
            pass  # refused before its end; the answer may be there
        sock = self.connection.sock
        answer = self.connection.getresponse()
        fields = {}
        for name, value in answer.getheaders():
            fields[name.lower()] = f"{fields[name.lower()]}, {value}" if name.lower() in fields else value
        is_stream = fields.get("content-type", "").startswith(STREAM) and method != "HEAD"
        data = self.beginning(answer, sock) if is_stream else answer.read()
        if is_stream or alone or answer.will_close:
            self.close()
        return Exchange(method, path, answer.status, fields, data, body, is_whole=not is_stream)

    def beginning(self, answer, sock):
        """What a stream says at once."""
        data = b""
        sock.settimeout(0.05)
        try:
            while len(data) < 100_000:
                piece = answer.read1(65536)
                if not piece:
                    break
                data += piece
        except (socket.timeout, http.client.HTTPException):
            pass
        return data
