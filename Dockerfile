# The studio of Maulstick in a container. Never built where this file was written, which has no Docker.
#
#     docker build --tag maulstick .
#     docker run --rm --init --publish 127.0.0.1:8337:8337 --volume maulstick:/studio maulstick
#
# docs/install.md says what it prints, how PyTorch comes without CUDA, and how a plotter is passed on.
FROM python:3.12-slim-bookworm AS build
RUN apt-get update && apt-get install --yes --no-install-recommends g++ && rm -rf /var/lib/apt/lists/*
COPY . /source
RUN PIP_CONSTRAINT=/source/constraints.txt pip wheel --no-cache-dir --no-deps --wheel-dir /wheel /source

FROM python:3.12-slim-bookworm
# Index that PyTorch comes from, where not from PyPI.
ARG TORCH_INDEX
RUN apt-get update && apt-get install --yes --no-install-recommends libmypaint-1.5-1 mypaint-brushes \
  && rm -rf /var/lib/apt/lists/*
RUN --mount=type=bind,source=constraints.txt,target=/constraints.txt \
  if [ -n "$TORCH_INDEX" ]; then \
    pip install --no-cache-dir --no-deps --index-url "$TORCH_INDEX" "$(grep '^torch==' /constraints.txt)"; \
  fi
RUN --mount=type=bind,source=constraints.txt,target=/constraints.txt \
  --mount=type=bind,from=build,source=/wheel,target=/wheel \
  pip install --no-cache-dir --constraint /constraints.txt "$(echo /wheel/*.whl)[camera,plan,studio,video,wacom]"

RUN useradd --create-home painter && install --directory --owner painter /studio
USER painter
VOLUME /studio
EXPOSE 8337
CMD ["maulstick", "studio", "/studio", "--host", "0.0.0.0", "--no-browser"]
