# The program with all that is pinned, where jobs run in containers: `docker build -t meecontact .`, then
# `docker run --rm --user "$(id -u):$(id -g)" -v "$PWD:/work" meecontact run quickstart` in a folder with
# config/quickstart.yaml. The program runs as no one's administrator; the base image is a tag, see docs/runs.md.
FROM python:3.11-slim
WORKDIR /meecontact
COPY . .
RUN python -m venv .venv \
    && .venv/bin/python -m pip install --no-cache-dir --require-hashes -r requirements/cloud.txt \
    && .venv/bin/python -m pip install --no-cache-dir --no-deps --no-build-isolation -e .
ENV PATH=/meecontact/.venv/bin:$PATH
ENV HOME=/tmp
WORKDIR /work
RUN chown 1000:1000 /work
USER 1000:1000
ENTRYPOINT ["meecontact"]
