#!/usr/bin/env python3
"""Serves the page of this folder's app/page/ for a running `poise view`, whose page may have been built from another:
serve.py ADDRESS [PORT]

ADDRESS is what `poise view` printed. The document is taken out of its page; all requests are handed on to it."""

import base64
import http.client
import http.server
import re
import sys
import threading
import urllib.parse
import zlib

from assemble import page

held = threading.local()


def asked(program, method, path, body=None):
    """The answer of the program, over one connection per thread. Its own authority: it refuses every other."""
    for _ in range(2):
        if getattr(held, "connection", None) is None:
            held.connection = http.client.HTTPConnection(program.hostname, program.port, timeout=60)
        try:
            headers = {"Origin": f"http://{program.netloc}", "Content-Type": "application/json"}
            held.connection.request(method, path, body, headers)
            answer = held.connection.getresponse()
            return answer, answer.read()
        except (http.client.HTTPException, ConnectionError):
            held.connection = None
    raise ConnectionError("the program does not answer")


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    program = None

    def do_GET(self):
        self.hand_on()

    def do_POST(self):
        self.hand_on(self.rfile.read(int(self.headers.get("Content-Length", 0))))

    def hand_on(self, body=None):
        try:
            answer, content = asked(self.program, self.command, self.path, body)
        except ConnectionError:
            self.close_connection = True
            return
        if self.path == self.program.path and answer.status == 200:
            document = re.search(r'<script type="text/plain" id="document">(.*?)</script>', content.decode(), re.S)
            content = page(zlib.decompress(base64.b64decode(document[1])).decode()).encode()
        self.send_response(answer.status)
        self.send_header("Content-Type", answer.getheader("Content-Type"))
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_):
        pass


if __name__ == "__main__":
    Handler.program = urllib.parse.urlsplit(sys.argv[1])
    server = http.server.ThreadingHTTPServer(("127.0.0.1", int(sys.argv[2]) if len(sys.argv) > 2 else 0), Handler)
    server.daemon_threads = True
    print(f"http://127.0.0.1:{server.server_port}{Handler.program.path}", flush=True)
    server.serve_forever()
