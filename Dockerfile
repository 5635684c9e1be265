# The program with all that is pinned, where jobs run in containers: `docker build -t meecontact .`, then
# `docker run --rm -v "$PWD:/work" meecontact run quickstart` in a folder with config/quickstart.yaml.
FROM python:3.11-slim
RUN apt-get update && apt-get install --yes --no-install-recommends make && rm -rf /var/lib/apt/lists/*
WORKDIR /meecontact
COPY . .
RUN make .venv/run.stamp
ENV PATH=/meecontact/.venv/bin:$PATH
WORKDIR /work
ENTRYPOINT ["meecontact"]
