"""GPUs of NVIDIA: the driver and the compiler through their own interfaces, without a toolkit or a C compiler."""
