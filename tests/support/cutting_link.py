"""A connection to a server that breaks, or that brings no more."""

import socket
import threading


class CuttingLink:
    """Passes bytes on to `address` and back. Each number of `cuts` is after how many bytes from the
    server one connection breaks; those that come later do not. Once a connection has brought `holds_after` bytes,
    `held` is set, and it brings no more and stays open until `go_on()`."""

    def __init__(self, address, cuts=(), holds_after=None):
        host, port = address.split(":")
        self.target, self.cuts = (host, int(port)), list(cuts)
        self.holds_after, self.held, self.goes_on = holds_after, threading.Event(), threading.Event()
        self.from_server = []  # bytes, of each connection
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self.listener.getsockname()[1]}"
        threading.Thread(target=self.accept, daemon=True).start()

    def go_on(self):
        self.goes_on.set()

    def close(self):
        self.go_on()
        self.listener.close()

    def accept(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            server = self.reach()
            if server is None:
                client.close()
                continue
            limit = self.cuts.pop(0) if self.cuts else None
            index = len(self.from_server)
            self.from_server.append(0)
            threading.Thread(target=self.up, args=(client, server), daemon=True).start()
            threading.Thread(
                target=self.down, args=(server, client, index, limit), daemon=True).start()

    def reach(self):
        """A connection to the server; None where it is away."""
        try:
            return socket.create_connection(self.target)
        except OSError:
            return None

    @staticmethod
    def up(client, server):
        try:
            while data := client.recv(65536):
                server.sendall(data)
        except OSError:
            pass
        server.close()

    def down(self, server, client, index, limit):
        try:
            while data := server.recv(65536):
                client.sendall(data)
                self.from_server[index] += len(data)
                if limit is not None and self.from_server[index] >= limit:
                    break
                if self.holds_after is not None and self.from_server[index] >= self.holds_after:
                    self.held.set()
                    self.goes_on.wait()
        except OSError:
            pass
        for end in (client, server):
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
            end.close()
