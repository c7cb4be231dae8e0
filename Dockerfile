# Two stages: the first builds the environment and compiles every kernel, the second takes only what serves.

FROM python:3.13-slim AS build
# Kernels for every processor of this architecture: code for the build machine's own would be a miss in the cache elsewhere.
ENV NUMBA_CPU_NAME=generic \
    NUMBA_CPU_FEATURES= \
    NUMBA_CACHE_DIR=/opt/mat/kernels \
    PYTHONDONTWRITEBYTECODE=1
WORKDIR /opt/mat
# Without pip, which what serves has no use for: the image's own installs.
RUN python -m venv --without-pip /opt/mat/venv
COPY requirements.lock ./
RUN pip --python /opt/mat/venv install --no-cache-dir --disable-pip-version-check --require-hashes -r requirements.lock
ENV PATH=/opt/mat/venv/bin:$PATH
COPY mat_core/ mat_core/
RUN python -W ignore::RuntimeWarning:runpy -m mat_core.warm
COPY service/ service/
COPY openapi/ openapi/
# By hash, not by time: a builder that sets the times of files anew would make every one of them stale.
RUN python -m compileall -q --invalidation-mode unchecked-hash mat_core service venv/lib

FROM python:3.13-slim
# Kernels are found by the hash of their sources and by the processor's name, wherever they lie; nothing writes beside them.
# Only MAT_DATA_DIR must be writable: jobs, and their database unless there is another.
ENV NUMBA_CPU_NAME=generic \
    NUMBA_CPU_FEATURES= \
    NUMBA_CACHE_DIR=/opt/mat/kernels \
    MAT_DATA_DIR=/var/lib/mat \
    PATH=/opt/mat/venv/bin:$PATH \
    PYTHONDONTWRITEBYTECODE=1
RUN useradd --uid 10001 --no-create-home --shell /usr/sbin/nologin mat && install -d -o mat -m 0700 /var/lib/mat
COPY --from=build /opt/mat /opt/mat
WORKDIR /opt/mat
USER 10001
VOLUME /var/lib/mat
EXPOSE 8000
HEALTHCHECK --interval=10s --timeout=3s --start-period=60s --retries=3 \
    CMD ["python", "-c", "import urllib.request as u; u.urlopen('http://127.0.0.1:8000/readyz', timeout=2)"]
CMD ["python", "-m", "service.cli", "serve", "--host", "0.0.0.0", "--port", "8000"]
