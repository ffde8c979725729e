"""Starts Debian's nginx, Varnish, Squid and HAProxy with the configurations of deploy/.

The files are taken as they are but for ports, servers, folders and certificates, each of which must
stand there exactly as written here. Everything a program writes goes into the folder it is given.
Runs as root, where the programs take their own users, or as anyone else.
"""
import os
import shlex
import signal
import subprocess
import time

from running_programs import Program, ask, counters, free_port

DEPLOY = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "deploy")
START_SECONDS = 30


def shipped(path, replacements):
    """A file of deploy/ with each of `replacements` (old, new) made; old must be there, once."""
    with open(os.path.join(DEPLOY, path), encoding="utf-8") as file:
        text = file.read()
    for old, new in replacements:
        if text.count(old) != 1:
            raise RuntimeError(f"deploy/{path}: {old!r} stands there {text.count(old)} times")
        text = text.replace(old, new)
    return text


def write_certificate(folder):
    """A key and a self-signed certificate; also one after the other in one file."""
    names = [os.path.join(folder, name) for name in ("tls.key", "tls.crt", "tls.pem")]
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt",
                    "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj", "/CN=localhost",
                    "-keyout", names[0], "-out", names[1]], check=True, capture_output=True)
    with open(names[2], "wb") as both:
        for name in names[:2]:
            with open(name, "rb") as part:
                both.write(part.read())
    return names


class RealCache:
    """One of the programs, over two services at `ports`."""
    name = ""
    tls_port = None
    refuses_long_urls = 414  # status for those that are too long for the program itself
    etag_in_304 = True

    def __init__(self, folder, bin_folder, ports):
        self.folder = os.path.join(folder, self.name)
        os.mkdir(self.folder)
        os.chmod(self.folder, 0o777)  # for the user that a program started by root becomes
        self.bin = bin_folder
        self.services = ports
        self.port = free_port()
        self.process = None
        self.helpers = []
        try:
            self.run(self.command())
            self.wait()
        except BaseException:
            self.stop()
            raise

    def command(self):
        raise NotImplementedError

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def run(self, command):
        with open(os.path.join(self.folder, "output"), "wb") as output:
            # Users other than root have no folders of system programs in their path.
            path = os.environ.get("PATH", "") + ":/usr/sbin:/sbin"
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=output,
                                            stderr=subprocess.STDOUT,
                                            env={**os.environ, "PATH": path})

    def wait(self):
        """Until it answers what the services say."""
        give_up = time.monotonic() + START_SECONDS
        while time.monotonic() < give_up and self.process.poll() is None:
            try:
                if ask(self.port, "/readyz").status == 200:
                    return
            except OSError:
                pass
            time.sleep(0.05)
        raise RuntimeError(f"{self.name} does not answer; it said:\n{self.said()}")

    def said(self):
        text = ""
        for name in ("output", "error.log", "cache.log"):
            path = os.path.join(self.folder, name)
            if os.path.exists(path):
                with open(path, encoding="utf-8", errors="replace") as file:
                    text += file.read()[-4000:]
        return text

    def stop(self):
        if self.process is not None and self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(timeout=15)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        for helper in self.helpers:
            helper.stop()
        self.helpers = []

    def is_hit(self, response, before):
        """Whether the cache answered by itself, by its own word (RFC 9211). `before` is what
        tally() gave before the request."""
        del before
        return "hit" in [part.strip() for part in response.headers["cache-status"].split(";")]

    def tally(self):
        return None


class Nginx(RealCache):
    name = "nginx"

    def command(self):
        self.tls_port = free_port()
        key, certificate, _ = write_certificate(self.folder)
        config = self.write("nginx.conf", shipped("nginx/nginx.conf", [
            ("server 127.0.0.1:8080 ", f"server 127.0.0.1:{self.services[0]} "),
            ("server 127.0.0.1:8082 ", f"server 127.0.0.1:{self.services[1]} "),
            ("listen 80 ", f"listen 127.0.0.1:{self.port} "),
            ("listen 443 ", f"listen 127.0.0.1:{self.tls_port} "),
            *((f"/var/lib/nginx/{name}", os.path.join(self.folder, name)) for name in
              ("meshfront-constants ", "meshfront-sets ", "body;", "proxy;", "fastcgi;", "uwsgi;",
               "scgi;")),
            ("/run/nginx.pid;", f"{self.folder}/nginx.pid;"),
            ("/var/log/nginx/error.log ", f"{self.folder}/error.log "),
            ("/etc/nginx/meshfront.crt;", f"{certificate};"),
            ("/etc/nginx/meshfront.key;", f"{key};"),
        ]))
        return ["nginx", "-c", config, "-e", os.path.join(self.folder, "error.log"),
                "-g", "daemon off;"]


class Varnish(RealCache):
    name = "Varnish"

    def command(self):
        vcl = self.write("meshfront.vcl", shipped("varnish/meshfront.vcl", [
            ('.port = "8080"', f'.port = "{self.services[0]}"'),
            ('.port = "8082"', f'.port = "{self.services[1]}"'),
        ]))
        unit = shipped("varnish/varnish.service.conf", [
            ("-a :6081 ", f"-a 127.0.0.1:{self.port} "),
            ("-f /etc/varnish/meshfront.vcl ", f"-f {vcl} "),
        ])
        start = unit.replace("\\\n", " ").rsplit("ExecStart=", 1)[1].splitlines()[0]
        return shlex.split(start) + ["-n", os.path.join(self.folder, "work")]


class Squid(RealCache):
    name = "Squid"
    refuses_long_urls = 400
    etag_in_304 = False  # in those of its own; RFC 9110 asks for it

    def is_hit(self, response, before):
        return response.headers["x-cache"].startswith("HIT ")

    def command(self):
        config = self.write("squid.conf", shipped("squid/squid.conf", [
            ("http_port 80 ", f"http_port 127.0.0.1:{self.port} "),
            ("127.0.0.1 parent 8080 ", f"127.0.0.1 parent {self.services[0]} "),
            ("127.0.0.1 parent 8082 ", f"127.0.0.1 parent {self.services[1]} "),
            ("/var/log/squid/cache.log", f"{self.folder}/cache.log"),
            ("/run/squid.pid", f"{self.folder}/squid.pid"),
        ]))
        return ["squid", "-N", "-f", config]


class HAProxy(RealCache):
    """HAProxy's own cache does not merge requests under way (2.6), so the cache here is
    meshfront-proxy: HAProxy balances two of them, and the services behind them."""
    name = "HAProxy"
    replicas_port = None  # past the proxies

    def command(self):
        self.tls_port = free_port()
        inner = self.replicas_port = free_port()
        for _ in range(2):
            self.helpers.append(Program(os.path.join(self.bin, "meshfront-proxy"), "--upstream",
                                        f"http://127.0.0.1:{inner}", "--listen", "127.0.0.1:0"))
        first, second = (helper.port for helper in self.helpers)
        certificate = write_certificate(self.folder)[2]
        config = self.write("haproxy.cfg", shipped("haproxy/haproxy.cfg", [
            ("bind :80\n", f"bind 127.0.0.1:{self.port}\n"),
            ("bind :443 ", f"bind 127.0.0.1:{self.tls_port} "),
            ("bind 127.0.0.1:8090\n", f"bind 127.0.0.1:{inner}\n"),
            ("/etc/haproxy/meshfront.pem", certificate),
            ("server proxy1 127.0.0.1:8081 check", f"server proxy1 127.0.0.1:{first} check"),
            ("server proxy2 127.0.0.1:8083 check", f"server proxy2 127.0.0.1:{second} check"),
            ("server proxy1 127.0.0.1:8081 track", f"server proxy1 127.0.0.1:{first} track"),
            ("server proxy2 127.0.0.1:8083 track", f"server proxy2 127.0.0.1:{second} track"),
            ("server service1 127.0.0.1:8080 ", f"server service1 127.0.0.1:{self.services[0]} "),
            ("server service2 127.0.0.1:8082 ", f"server service2 127.0.0.1:{self.services[1]} "),
        ]))
        return ["haproxy", "-db", "-f", config]

    def tally(self):
        """Documents and records that the proxies had."""
        return sum(counted["meshfront_cache_document_hits_total"] +
                   counted["meshfront_cache_record_hits_total"]
                   for counted in (counters(helper.port) for helper in self.helpers))

    def is_hit(self, response, before):
        return "age" in response.headers and self.tally() > before
