# One image that serves, dumps statistics and tests itself, on lavapipe: no GPU, no shell, nothing that is not used.
#
#   docker build -t samplerscope .
#   docker run -p 8000:8000 samplerscope                      the service
#   docker run samplerscope stats --technique cosine          the command line
#
# Build arguments: MESA=bookworm or bookworm-backports; OWN_GLSL=yes keeps the GLSL compiler, no leaves it out.
# The optional secrets `pipconf` and `ca` give pip a configuration and a bundle of certificates.

FROM debian:bookworm-slim AS build
ARG MESA=bookworm
ARG OWN_GLSL=yes
ENV DEBIAN_FRONTEND=noninteractive PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_CACHE_DIR=1
RUN if [ "$MESA" != bookworm ]; then \
        if [ -f /etc/apt/sources.list.d/debian.sources ]; then \
            sed -i "s/^Suites: bookworm bookworm-updates$/& $MESA/" /etc/apt/sources.list.d/debian.sources; \
        else \
            sed -nE "s/^(deb .*) bookworm main.*/\1 $MESA main/p" /etc/apt/sources.list > /etc/apt/sources.list.d/mesa.list; \
        fi; \
    fi \
    && apt-get update --quiet \
    && apt-get install --quiet --yes --no-install-recommends \
        binutils ca-certificates glslang-tools libvulkan1 python3 python3-venv \
    && apt-get install --quiet --yes --no-install-recommends --target-release "$MESA" mesa-vulkan-drivers \
    && rm -rf /var/lib/apt/lists/*

WORKDIR /source
COPY requirements.lock ./
RUN --mount=type=secret,id=pipconf,target=/etc/pip.conf,required=false \
    --mount=type=secret,id=ca,target=/run/build-ca.crt,required=false \
    python3 -m venv /opt/samplerscope \
    && /opt/samplerscope/bin/pip install --quiet --require-hashes --requirement requirements.lock
COPY pyproject.toml README.md ./
COPY lavapipe lavapipe
COPY service service
COPY shaders shaders
RUN --mount=type=secret,id=pipconf,target=/etc/pip.conf,required=false \
    --mount=type=secret,id=ca,target=/run/build-ca.crt,required=false \
    /opt/samplerscope/bin/pip install --quiet --no-deps . \
    && /opt/samplerscope/bin/pip uninstall --quiet --yes pip setuptools \
    && find /opt/samplerscope -depth -type d -name tests -path '*/numpy/*' -exec rm -rf {} + \
    && strip --strip-unneeded /opt/samplerscope/lib/python3.11/site-packages/uvloop/*.so

# Compiles every shader of the catalogue once, so that a container starts with warm caches.
ENV SAMPLERSCOPE_CACHE_DIR=/opt/cache/samplerscope MESA_SHADER_CACHE_DIR=/opt/cache/mesa
RUN mkdir -p /opt/cache/mesa && cd / && /opt/samplerscope/bin/python -m service.container warm $([ "$OWN_GLSL" = yes ] || echo everything)

# The image: the interpreter, the environment, lavapipe, and the libraries these link to.
RUN set -eu; \
    mkdir -p /image/usr/bin /image/usr/lib /image/usr/lib64 /image/etc /image/tmp /image/var/lib/samplerscope; \
    ln -s usr/bin /image/bin; ln -s usr/lib /image/lib; ln -s usr/lib64 /image/lib64; \
    arch="$(dirname "$(find /usr/lib -name libvulkan_lvp.so)")"; \
    if [ "$OWN_GLSL" = yes ]; then compiler=/usr/bin/glslangValidator; else compiler=; fi; \
    for file in /usr/bin/python3.11 $compiler "$arch/libvulkan.so.1" "$arch/libvulkan_lvp.so" \
            $(find /opt/samplerscope /usr/lib/python3.11 -name '*.so*' -type f); do \
        echo "$file"; ldd "$file" 2>/dev/null | sed -nE 's/.*=> (\/[^ ]+) .*/\1/p; s/^[[:space:]]*(\/[^ ]+) \(.*/\1/p'; \
    done | sort -u | grep -v '^/opt/' | while read -r file; do cp --dereference --preserve=timestamps --parents "$file" /image; done; \
    cp -a /usr/lib/python3.11 /usr/lib/python3 /image/usr/lib/; \
    rm -rf /image/usr/lib/python3/dist-packages /image/usr/lib/python3.11/ensurepip /image/usr/lib/python3.11/lib2to3 \
        /image/usr/lib/python3.11/idlelib /image/usr/lib/python3.11/pydoc_data /image/usr/lib/python3.11/test /image/usr/lib/python3.11/tkinter; \
    ln -s python3.11 /image/usr/bin/python3; \
    cp --parents /usr/share/vulkan/icd.d/lvp_icd*.json /image; \
    mkdir -p /image/opt; cp -a /opt/samplerscope /opt/cache /image/opt/; \
    find /image/opt/samplerscope -type f \( -name '*.pyi' -o -name '*.h' \) -delete; \
    chmod -R a+rX /image/opt/cache; \
    echo 'samplerscope:x:10001:10001::/tmp:/sbin/nologin' > /image/etc/passwd; \
    echo 'samplerscope:x:10001:' > /image/etc/group; \
    chmod 1777 /image/tmp; chown 10001:10001 /image/var/lib/samplerscope


FROM scratch
ARG VERSION=0.1.0
LABEL org.opencontainers.image.title="samplerscope" \
      org.opencontainers.image.description="How noisy, how right and how fast a BRDF sampler is" \
      org.opencontainers.image.version="$VERSION"
COPY --from=build /image /
ENV PATH=/opt/samplerscope/bin:/usr/bin \
    PYTHONUNBUFFERED=1 \
    HOME=/tmp \
    SAMPLERSCOPE_CACHE_DIR=/tmp/cache/samplerscope \
    MESA_SHADER_CACHE_DIR=/tmp/cache/mesa \
    SAMPLERSCOPE_WARM_CACHE=/opt/cache \
    SAMPLERSCOPE_HOST=0.0.0.0 \
    SAMPLERSCOPE_PORT=8000 \
    SAMPLERSCOPE_DATA_DIR=/var/lib/samplerscope
USER 10001:10001
WORKDIR /tmp
EXPOSE 8000
VOLUME /var/lib/samplerscope
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=30s --timeout=10s --start-period=15s \
    CMD ["/opt/samplerscope/bin/python", "-m", "service.container", "healthy"]
ENTRYPOINT ["/opt/samplerscope/bin/python", "-m", "service.container"]
CMD ["serve"]
