# Varnish as a cache in front of replicas of meshfront-serve: install it as
# /etc/varnish/meshfront.vcl, with varnish.service.conf beside it. Adapt the two backends.
vcl 4.1;

import directors;
import std;

probe ready {
    .url = "/readyz";
    .interval = 1s;
    .timeout = 1s;
    .window = 3;
    .threshold = 2;
    .initial = 2;
}
backend service1 {
    .host = "127.0.0.1";
    .port = "8080";
    .probe = ready;
    .connect_timeout = 1s;
    .first_byte_timeout = 30s;
}
backend service2 {
    .host = "127.0.0.1";
    .port = "8082";
    .probe = ready;
    .connect_timeout = 1s;
    .first_byte_timeout = 30s;
}

sub vcl_init {
    new services = directors.round_robin();
    services.add_backend(service1);
    services.add_backend(service2);
}

sub vcl_recv {
    if (req.url == "/metrics") {
        return (synth(404));
    }
    set req.backend_hint = services.backend();
    # Answers depend on nothing but method, URL and content. With these Varnish would not cache.
    unset req.http.Cookie;
    unset req.http.Authorization;
    # While a backend is there, nothing is served that is older than allowed by more than this; with
    # all away, what there is (beresp.grace).
    if (std.healthy(req.backend_hint)) {
        set req.grace = 5s;
    }
    if (req.method == "QUERY") {
        # Held so that it can be sent again where a connection broke. The service takes 1 MiB.
        if (!std.cache_req_body(1100KB)) {
            return (synth(413));
        }
        return (pass);
    }
    if ((req.method == "GET" || req.method == "HEAD") && req.url ~ "^/v1/") {
        return (hash);
    }
    return (pass);
}

sub vcl_hash {
    # Not by Host: each thing has exactly one URL.
    hash_data(req.url);
    return (lookup);
}

sub vcl_hit {
    set req.http.X-Cache-Status = "varnish; hit";
}
sub vcl_miss {
    set req.http.X-Cache-Status = "varnish; fwd=uri-miss";
}
sub vcl_pass {
    set req.http.X-Cache-Status = "varnish; fwd=bypass";
}

sub vcl_backend_fetch {
    unset bereq.http.X-Cache-Status;
}

sub vcl_backend_response {
    if (beresp.http.Cache-Control ~ "no-store") {
        # Errors: remembered briefly, so that a flood of wrong URLs fills nothing.
        set beresp.uncacheable = true;
        set beresp.ttl = 1s;
        return (deliver);
    }
    # Answers to exact sets are asked for again rarely: in a storage of their own they cannot push
    # the constants out.
    if (bereq.url ~ "/splits/") {
        set beresp.storage = storage.sets;
        set beresp.ttl = 1h;
        return (deliver);
    }
    set beresp.storage = storage.constants;
    set beresp.grace = 1h;
    set beresp.keep = 1h;
    return (deliver);
}

sub vcl_deliver {
    # Varnish compares with one entity tag; clients may send a list.
    if (req.http.If-None-Match == "*" ||
        std.strstr(req.http.If-None-Match, resp.http.ETag)) {
        set req.http.If-None-Match = resp.http.ETag;
    }
    if (req.http.X-Cache-Status) {
        set resp.http.Cache-Status = req.http.X-Cache-Status;
    }
    return (deliver);
}
