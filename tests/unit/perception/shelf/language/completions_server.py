"""A completions server for tests: a real one on a real port, with a model of letters inside."""

import json
import math
import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer


def word_log(text, word):
    """Say how likely a word is after a text: the likelier, the more letters they share."""
    shared = len(set(text.lower()) & set(word.lower()))
    return -1.0 - 10.0 / (1.0 + shared) - 0.1 * len(word)


def tokens_of(text):
    """Cut a text before its spaces, as most tokenizers do."""
    pieces = text.split(" ")
    return [pieces[0], *(f" {piece}" for piece in pieces[1:])]


def choice_of(index, text):
    tokens = tokens_of(text)
    logs = [None] + [word_log("".join(tokens[:at]), tokens[at]) for at in range(1, len(tokens))]
    # One token is made up at the end, since servers make at least one.
    return {
        "index": index,
        "text": text + " and",
        "logprobs": {"tokens": [*tokens, " and"], "token_logprobs": [*logs, math.log(0.5)]},
    }


class _Handler(BaseHTTPRequestHandler):
    def do_POST(self):
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.server.asked.append((self.path, body, self.headers.get("Authorization")))
        status, answer = self.server.reply(body)
        payload = answer if isinstance(answer, bytes) else json.dumps(answer).encode()
        self.send_response(status)
        self.send_header("Content-Length", str(len(payload)))
        self.end_headers()
        self.wfile.write(payload)

    def log_message(self, *_):
        pass


def scores(body):
    choices = [choice_of(index, text) for index, text in enumerate(body["prompt"])]
    return 200, {"object": "text_completion", "choices": choices[::-1]}


@contextmanager
def completions_server(reply=scores):
    server = ThreadingHTTPServer(("127.0.0.1", 0), _Handler)
    server.reply, server.asked = reply, []
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/v1", server.asked
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
