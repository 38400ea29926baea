# SPDX-License-Identifier: GPL-3.0-or-later
"""Slow clients by the thousand, in a process of their own: slow_clients.py HOST PORT COUNT.

A quarter of them says nothing, a quarter says nothing after one request, a quarter drips a header, a quarter drips a
body, and a few ask for much and take nothing of it; whoever is cut off comes back. It prints "held" once all are
connected, runs until its standard input ends, and prints how many are connected and how often one came back."""
import errno
import resource
import select
import socket
import sys
import time

HEADER = b"GET /health HTTP/1.1\r\nHost: x\r\nX-Slow: "
BODY = (b"POST /processes/merge/execution HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
        b"Content-Length: 1000000\r\n\r\n")
ONCE = b"GET /health HTTP/1.1\r\nHost: x\r\n\r\n"
GREEDY = b"GET /openapi.json HTTP/1.1\r\nHost: x\r\n\r\n" * 20
GREEDY_ONES = 16
OPENINGS = [b"", HEADER, BODY, ONCE]
DRIPS = [False, True, True, False]


class Crowd:
    def __init__(self, place, count):
        self.place = place
        self.clients = [None] * count
        self.poll = select.epoll()
        self.by_file = {}
        self.reconnects = -count

    def connect(self, i):
        client = socket.socket()
        client.setblocking(False)
        if i < GREEDY_ONES:
            client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        error = client.connect_ex(self.place)
        if error not in (0, errno.EINPROGRESS):
            client.close()
            return
        self.clients[i] = client
        self.by_file[client.fileno()] = i
        self.reconnects += 1
        self.poll.register(client, select.EPOLLOUT | select.EPOLLHUP | select.EPOLLRDHUP)

    def drop(self, i):
        client = self.clients[i]
        self.by_file.pop(client.fileno(), None)
        client.close()
        self.clients[i] = None

    def turn(self, seconds):
        """Sees to what happens within the time."""
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0:
            for file, events in self.poll.poll(left, 1000):
                i = self.by_file.get(file)
                if i is None:
                    continue
                if events & (select.EPOLLHUP | select.EPOLLERR | select.EPOLLRDHUP):
                    self.drop(i)
                elif events & select.EPOLLOUT:
                    self.poll.modify(file, select.EPOLLRDHUP)
                    self.send(i, GREEDY if i < GREEDY_ONES else OPENINGS[i % 4])

    def send(self, i, data):
        try:
            if data:
                self.clients[i].send(data)
        except BlockingIOError:
            pass
        except OSError:
            self.drop(i)

    def drip(self):
        for i, client in enumerate(self.clients):
            if client is None:
                self.connect(i)
            elif i >= GREEDY_ONES and DRIPS[i % 4]:
                self.send(i, b"a")


def main():
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    crowd = Crowd((sys.argv[1], int(sys.argv[2])), int(sys.argv[3]))
    for i in range(len(crowd.clients)):
        crowd.connect(i)
        if i % 100 == 99:
            crowd.turn(0.01)
    crowd.turn(0.5)
    print("held", flush=True)
    while not select.select([sys.stdin], [], [], 0)[0]:
        crowd.drip()
        crowd.turn(1)
    print(sum(client is not None for client in crowd.clients), crowd.reconnects, flush=True)


if __name__ == "__main__":
    main()
