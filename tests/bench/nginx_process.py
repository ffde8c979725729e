"""An nginx of one worker on a free port, all of whose files lie in one folder."""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time

MAIN = """
{user}
daemon off;
worker_processes 1;
pid {folder}/nginx.pid;
error_log {folder}/error.log;
events {{ worker_connections 4096; }}
http {{
  client_body_temp_path {folder}/body;
  proxy_temp_path {folder}/proxy;
  fastcgi_temp_path {folder}/fastcgi;
  uwsgi_temp_path {folder}/uwsgi;
  scgi_temp_path {folder}/scgi;
  {http}
}}
"""


class NginxProcess:
    """Ended with the block. `http`: what stands in the block of that name, with FOLDER and PORT for
    the folder and the port. `prefix`: what starts it, taskset for example."""

    def __init__(self, folder, http, prefix=()):
        self.folder = folder
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.url = f"http://127.0.0.1:{self.port}"
        user = "user root;" if os.geteuid() == 0 else ""  # for the folder, which is the caller's
        own = http.replace("FOLDER", str(folder)).replace("PORT", str(self.port))
        (folder / "nginx.conf").write_text(MAIN.format(user=user, folder=folder, http=own))
        self.process = subprocess.Popen(
            [*prefix, "nginx", "-c", folder / "nginx.conf", "-e", folder / "error.log"],
            stderr=subprocess.DEVNULL,
        )

    def __enter__(self):
        for _ in range(100):
            with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", self.port), 1):
                return self
            time.sleep(0.05)
        sys.exit("nginx does not start")

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGQUIT)
        self.process.wait()
