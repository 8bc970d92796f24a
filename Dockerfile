# This project with the packages of requirements.lock:
#   docker build --tag visuohaptic .
#   docker run --rm --volume "$PWD/run:/run/visuohaptic" visuohaptic -j2
FROM debian:bookworm-slim

# git is for DVC; the lib… are Open3D's.
RUN apt-get update \
  && apt-get install --yes --no-install-recommends ca-certificates git libegl1 libgl1 libgomp1 python3-venv \
  && rm -rf /var/lib/apt/lists/*

ENV PIP_NO_CACHE_DIR=1
WORKDIR /visuohaptic
# The packages come first: an edit of the project leaves their layer as it is.
COPY requirements.lock requirements-dev.lock set_up.sh ./
RUN ./set_up.sh packages \
  && .venv/bin/python -m pip install --constraint requirements-dev.lock dvc-s3 snakemake-storage-plugin-s3
COPY . .
RUN ./set_up.sh package

# Results are written where the run starts, which is a folder of the user's.
ENV PATH=/visuohaptic/.venv/bin:$PATH
WORKDIR /run/visuohaptic
ENTRYPOINT ["snakemake", "--snakefile", "/visuohaptic/Snakefile"]
CMD ["--cores", "all"]
