"""Opens viewer.html on a baked folder in headless Chromium and writes the picture that the page sends back.

Usage: capture.py CHROMIUM FOLDER OUT.png QUERY
"""
import http.server
import os
import subprocess
import sys
import tempfile
import threading
import urllib.parse

browser, folder, out, query = sys.argv[1:]
here = os.path.dirname(os.path.abspath(__file__))
answer = {}
arrived = threading.Event()


class Handler(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        name = os.path.basename(urllib.parse.urlparse(self.path).path)
        path = os.path.join(here if name == "viewer.html" else folder, name)
        if not os.path.isfile(path):
            self.send_error(404)
            return
        with open(path, "rb") as file:
            body = file.read()
        self.send_response(200)
        self.send_header("Content-Type", "text/html" if name.endswith(".html") else "application/octet-stream")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_POST(self):
        answer[os.path.basename(self.path)] = self.rfile.read(int(self.headers["Content-Length"]))
        self.send_response(204)
        self.end_headers()
        arrived.set()

    def log_message(self, *args):
        pass


server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
threading.Thread(target=server.serve_forever, daemon=True).start()
with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
    page = subprocess.Popen(
        [browser, "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--use-angle=gl-egl", "--ignore-gpu-blocklist",
         "--user-data-dir=" + profile, f"http://127.0.0.1:{server.server_port}/viewer.html?{query}"],
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    log = []
    threading.Thread(target=lambda: log.extend(page.stderr), daemon=True).start()
    done = arrived.wait(120)
    page.kill()
    page.wait()
if "picture" not in answer:
    sys.stderr.write(answer.get("failed", b"the page sent no picture in 120 s").decode() + "\n")
    sys.stderr.writelines(line.decode(errors="replace") for line in log[-5:])
    sys.exit(1)
with open(out, "wb") as file:
    file.write(answer["picture"])
