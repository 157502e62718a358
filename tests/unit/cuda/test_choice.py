"""Which device a name means, and one line for what is missing."""

from __future__ import annotations

import pytest

from sgicodec.cuda import choice
from sgicodec.cuda.choice import NamedDevice, decoding_device_of, device_of, own_device_of
from sgicodec.device import Device
from sgicodec.errors import MissingExtraError, NoDeviceError, UsageError


@pytest.fixture
def _two_gpus(monkeypatch: pytest.MonkeyPatch) -> None:
    def usable(number: int) -> int:
        if number > 1:
            raise NoDeviceError(f"no GPU {number}: this machine has 2")
        return 2

    monkeypatch.setattr(choice, "_usable", usable)


@pytest.mark.usefixtures("_two_gpus")
def test_names() -> None:
    assert device_of("cpu", 3) == Device(3)
    assert device_of("auto", 3) == device_of("cuda", 3) == Device(3, gpu=0, gpus=2)
    assert device_of("cuda:0", 3) == Device(3, gpu=0)
    assert device_of("cuda:1") == Device(gpu=1)
    with pytest.raises(NoDeviceError, match="no GPU 2"):
        device_of("cuda:2")
    assert decoding_device_of("auto", 3) == decoding_device_of("cpu", 3) == Device(3)
    assert decoding_device_of("cuda", 3) == Device(3, gpu=0)
    assert decoding_device_of("cuda:1") == Device(gpu=1)


@pytest.mark.usefixtures("_two_gpus")
def test_names_for_one_of_several_processes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sgicodec.cuda.claim.claimed_gpu", lambda: 1)
    assert own_device_of("cpu", 3) == Device(3)
    assert own_device_of("auto", 3) == own_device_of("cuda", 3) == Device(3, gpu=1)
    assert own_device_of("cuda:0") == Device(gpu=0)
    assert NamedDevice("cuda", Device(2, "portable")).of_tile(7) == Device(2, "portable", gpu=1)
    monkeypatch.setattr("sgicodec.cuda.claim.claimed_gpu", lambda: 2)
    assert NamedDevice("auto", Device(2, "portable")).of_tile(7) == Device(2, "portable")
    with pytest.raises(NoDeviceError, match="no GPU 2"):
        NamedDevice("cuda", Device(2)).of_tile(7)


@pytest.mark.parametrize("error", [NoDeviceError("no driver"), MissingExtraError("no NVRTC"), MemoryError("full")])
def test_auto_takes_the_processor_where_cuda_says_why_not(error: Exception, monkeypatch: pytest.MonkeyPatch) -> None:
    def usable(number: int) -> int:
        raise error

    monkeypatch.setattr(choice, "_usable", usable)
    assert device_of("auto", 2) == Device(2)
    with pytest.raises(type(error), match=str(error)):
        device_of("cuda")


@pytest.mark.parametrize("name", ["", "gpu", "cuda:", "cuda:x", "cuda:-1", "cuda:1 ", "CUDA"])
def test_other_names(name: str) -> None:
    with pytest.raises(UsageError, match="auto, cpu, cuda or cuda:N"):
        device_of(name)


@pytest.mark.parametrize("gpu", [-1, 1.5, "0", True])
def test_a_gpu_is_a_number(gpu: object) -> None:
    with pytest.raises(UsageError, match="gpu"):
        Device(gpu=gpu)  # type: ignore[arg-type]


def test_tiles_take_gpus_in_turn() -> None:
    assert [Device(2, gpu=1, gpus=3).of_tile(number) for number in range(4)] == [Device(2, gpu=g) for g in (1, 2, 3, 1)]
    assert Device(2, gpu=1).of_tile(5) == Device(2, gpu=1)
    assert Device(2).of_tile(5) == Device(2)


@pytest.mark.parametrize("gpus", [0, 1.5, True])
def test_how_many_gpus_is_a_number(gpus: object) -> None:
    with pytest.raises(UsageError, match="gpus"):
        Device(gpu=0, gpus=gpus)  # type: ignore[arg-type]
