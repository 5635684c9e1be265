# The program with all that is pinned, where jobs run in containers: `docker build -t meecontact .`, then
# `docker run --rm --user "$(id -u):$(id -g)" -v "$PWD:/work" meecontact run quickstart` in a folder with
# config/quickstart.yaml. The program runs as no one's administrator; the base image is a tag, see docs/runs.md.
FROM python:3.11-slim
RUN apt-get update && apt-get install --yes --no-install-recommends make && rm -rf /var/lib/apt/lists/*
WORKDIR /meecontact
COPY . .
RUN make .venv/run.stamp
ENV PATH=/meecontact/.venv/bin:$PATH
ENV HOME=/tmp
WORKDIR /work
RUN chown 1000:1000 /work
USER 1000:1000
ENTRYPOINT ["meecontact"]
