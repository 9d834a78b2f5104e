/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ngspice/sandbox.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

/* The architecture whose system call numbers the filter knows; on another one there is no filter.
 */
#if defined __x86_64__
#define MACHINE AUDIT_ARCH_X86_64
#define FIRST_OF_X32 0x40000000u
#elif defined __aarch64__
#define MACHINE AUDIT_ARCH_AARCH64
#else
#define MACHINE 0u
#endif

/* ---- which calls ---- */

/* The compiler's checker of leaks looks at its own process by tracing it. */
#ifdef __SANITIZE_ADDRESS__
#define TRACING VS_SANDBOX_TRIAL
#else
#define TRACING VS_SANDBOX_NETWORK
#endif

/* A call is refused from its level on. Numbers that one of the two machines lacks are left out for
 * it: there the call with "at" behind its name is the only one. */
typedef struct refusal {
  int number;
  vs_sandbox from;
} refusal;

static const refusal REFUSED[] = {
    {SYS_socket, VS_SANDBOX_NETWORK},
    {SYS_socketpair, VS_SANDBOX_NETWORK},
    {SYS_connect, VS_SANDBOX_NETWORK},
    {SYS_bind, VS_SANDBOX_NETWORK},
    {SYS_listen, VS_SANDBOX_NETWORK},
#ifdef SYS_accept /* i386 has it by accept4 alone */
    {SYS_accept, VS_SANDBOX_NETWORK},
#endif
    {SYS_accept4, VS_SANDBOX_NETWORK},
    {SYS_io_uring_setup, VS_SANDBOX_NETWORK}, /* would do all of these by another way */
    {SYS_io_uring_enter, VS_SANDBOX_NETWORK},
    {SYS_io_uring_register, VS_SANDBOX_NETWORK},
    {SYS_ptrace, TRACING},
    {SYS_process_vm_readv, VS_SANDBOX_NETWORK},
    {SYS_process_vm_writev, VS_SANDBOX_NETWORK},
    {SYS_pidfd_getfd, VS_SANDBOX_NETWORK},
    {SYS_bpf, VS_SANDBOX_NETWORK},
    {SYS_perf_event_open, VS_SANDBOX_NETWORK},
    {SYS_userfaultfd, VS_SANDBOX_NETWORK},
    {SYS_keyctl, VS_SANDBOX_NETWORK},
    {SYS_add_key, VS_SANDBOX_NETWORK},
    {SYS_request_key, VS_SANDBOX_NETWORK},
    {SYS_mount, VS_SANDBOX_NETWORK},
    {SYS_umount2, VS_SANDBOX_NETWORK},
    {SYS_pivot_root, VS_SANDBOX_NETWORK},
    {SYS_chroot, VS_SANDBOX_NETWORK},
    {SYS_setns, VS_SANDBOX_NETWORK},
    {SYS_unshare, VS_SANDBOX_NETWORK},
    {SYS_open_by_handle_at, VS_SANDBOX_NETWORK},
    {SYS_init_module, VS_SANDBOX_NETWORK},
    {SYS_finit_module, VS_SANDBOX_NETWORK},
    {SYS_delete_module, VS_SANDBOX_NETWORK},
    {SYS_kexec_load, VS_SANDBOX_NETWORK},
    {SYS_reboot, VS_SANDBOX_NETWORK},
    {SYS_swapon, VS_SANDBOX_NETWORK},
    {SYS_swapoff, VS_SANDBOX_NETWORK},
    {SYS_sethostname, VS_SANDBOX_NETWORK},
    {SYS_settimeofday, VS_SANDBOX_NETWORK},
    {SYS_clock_settime, VS_SANDBOX_NETWORK},
    {SYS_execve, VS_SANDBOX_WORKER},
    {SYS_execveat, VS_SANDBOX_WORKER},
    {SYS_shmget, VS_SANDBOX_WORKER}, /* and what else other processes could share with it */
    {SYS_shmat, VS_SANDBOX_WORKER},
    {SYS_msgget, VS_SANDBOX_WORKER},
    {SYS_semget, VS_SANDBOX_WORKER},
    {SYS_mq_open, VS_SANDBOX_WORKER},
    {SYS_kill, VS_SANDBOX_TRIAL},
    {SYS_tkill, VS_SANDBOX_TRIAL},
    {SYS_pidfd_send_signal, VS_SANDBOX_TRIAL},
    {SYS_unlinkat, VS_SANDBOX_TRIAL},
    {SYS_renameat2, VS_SANDBOX_TRIAL},
    {SYS_mkdirat, VS_SANDBOX_TRIAL},
    {SYS_linkat, VS_SANDBOX_TRIAL},
    {SYS_symlinkat, VS_SANDBOX_TRIAL},
    {SYS_mknodat, VS_SANDBOX_TRIAL},
    {SYS_fchmodat, VS_SANDBOX_TRIAL},
    {SYS_fchmod, VS_SANDBOX_TRIAL},
    {SYS_fchownat, VS_SANDBOX_TRIAL},
    {SYS_fchown, VS_SANDBOX_TRIAL},
    {SYS_truncate, VS_SANDBOX_TRIAL},
    {SYS_utimensat, VS_SANDBOX_TRIAL},
    {SYS_setxattr, VS_SANDBOX_TRIAL},
    {SYS_lsetxattr, VS_SANDBOX_TRIAL},
    {SYS_fsetxattr, VS_SANDBOX_TRIAL},
#ifdef SYS_renameat
    {SYS_renameat, VS_SANDBOX_TRIAL},
#endif
#ifdef SYS_unlink
    {SYS_fork, VS_SANDBOX_TRIAL},
    {SYS_vfork, VS_SANDBOX_TRIAL},
    {SYS_creat, VS_SANDBOX_TRIAL},
    {SYS_unlink, VS_SANDBOX_TRIAL},
    {SYS_rename, VS_SANDBOX_TRIAL},
    {SYS_mkdir, VS_SANDBOX_TRIAL},
    {SYS_rmdir, VS_SANDBOX_TRIAL},
    {SYS_link, VS_SANDBOX_TRIAL},
    {SYS_symlink, VS_SANDBOX_TRIAL},
    {SYS_mknod, VS_SANDBOX_TRIAL},
    {SYS_chmod, VS_SANDBOX_TRIAL},
    {SYS_chown, VS_SANDBOX_TRIAL},
    {SYS_lchown, VS_SANDBOX_TRIAL},
    {SYS_utime, VS_SANDBOX_TRIAL},
    {SYS_utimes, VS_SANDBOX_TRIAL},
#endif
};
enum { N_REFUSED = sizeof REFUSED / sizeof *REFUSED };

/* ---- the filter ---- */

/* A program for the kernel's packet filter (BPF), which looks at one number at a time. */
typedef struct program {
  struct sock_filter step[2 * N_REFUSED + 48];
  unsigned short count;
} program;

static void add_instruction(program *p, int code, uint32_t value, int if_true, int if_false) {
  p->step[p->count++] = (struct sock_filter){(unsigned short)code, (unsigned char)if_true,
                                             (unsigned char)if_false, value};
}

static void add_load(program *p, size_t offset) {
  add_instruction(p, BPF_LD | BPF_W | BPF_ABS, (uint32_t)offset, 0, 0);
}

static void add_refusal(program *p, int why) {
  add_instruction(p, BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ((uint32_t)why & SECCOMP_RET_DATA), 0, 0);
}

static void allow(program *p) {
  add_instruction(p, BPF_RET | BPF_K, SECCOMP_RET_ALLOW, 0, 0);
}

/* The low half of a call's argument, where flags are; both machines have it first. */
static size_t argument(int k) {
  return offsetof(struct seccomp_data, args) + (size_t)k * sizeof(uint64_t);
}

/* Refuses call `number` by the low half of its argument k: where any of these bits is set in it, or
 * where none is. */
static void refuse_bits(program *p, int number, int k, uint32_t bits, bool set) {
  add_instruction(p, BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)number, 0, 4);
  add_load(p, argument(k));
  add_instruction(p, BPF_JMP | BPF_JSET | BPF_K, bits, !set, set);
  add_refusal(p, EPERM);
  allow(p);
}

/* Refuses to insert characters into the terminal's input, as if the user had typed them. */
static void refuse_typing(program *p) {
  add_instruction(p, BPF_JMP | BPF_JEQ | BPF_K, SYS_ioctl, 0, 5);
  add_load(p, argument(1));
  add_instruction(p, BPF_JMP | BPF_JEQ | BPF_K, TIOCSTI, 1, 0);
  add_instruction(p, BPF_JMP | BPF_JEQ | BPF_K, TIOCLINUX, 0, 1);
  add_refusal(p, EPERM);
  allow(p);
}

/* Allows `clone` for threads alone, which ngspice may use. Of clone3 and openat2 the flags lie
 * where the filter cannot look; programs fall back to the older calls where these are not there. */
static void refuse_processes(program *p) {
  refuse_bits(p, SYS_clone, 0, CLONE_THREAD, false);
  add_instruction(p, BPF_JMP | BPF_JEQ | BPF_K, SYS_clone3, 0, 1);
  add_refusal(p, ENOSYS);
}

/* A process may signal itself, as abort() does, and no other. */
static void refuse_signals(program *p) {
  add_instruction(p, BPF_JMP | BPF_JEQ | BPF_K, SYS_tgkill, 0, 4);
  add_load(p, argument(0));
  add_instruction(p, BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)getpid(), 1, 0);
  add_refusal(p, EPERM);
  allow(p);
}

static void refuse_writing(program *p) {
  const uint32_t writes = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC;
#ifdef SYS_open
  refuse_bits(p, SYS_open, 1, writes, true);
#endif
  refuse_bits(p, SYS_openat, 2, writes, true);
  add_instruction(p, BPF_JMP | BPF_JEQ | BPF_K, SYS_openat2, 0, 1);
  add_refusal(p, ENOSYS);
}

static void write_program(program *p, vs_sandbox level) {
  add_load(p, offsetof(struct seccomp_data, arch));
  add_instruction(p, BPF_JMP | BPF_JEQ | BPF_K, MACHINE, 1, 0);
  /* a call through the interface of another architecture has other numbers */
  add_refusal(p, EPERM);
  add_load(p, offsetof(struct seccomp_data, nr));
#ifdef FIRST_OF_X32
  add_instruction(p, BPF_JMP | BPF_JGE | BPF_K, FIRST_OF_X32, 0, 1);
  add_refusal(p, EPERM);
#endif
  for (size_t k = 0; k < N_REFUSED; k++) {
    if (REFUSED[k].from > level) continue;
    add_instruction(p, BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)REFUSED[k].number, 0, 1);
    add_refusal(p, EPERM);
  }
  refuse_typing(p);
  if (level == VS_SANDBOX_TRIAL) {
    refuse_processes(p);
    refuse_signals(p);
    refuse_writing(p);
  }
  allow(p);
}

/* ---- at work ---- */

/* The memory checkers of the compiler reserve terabytes of addresses. */
static void limit_memory(void) {
#if !defined __SANITIZE_ADDRESS__
  const struct rlimit most = {VS_SANDBOX_TRIAL_BYTES, VS_SANDBOX_TRIAL_BYTES}, none = {0, 0};
  struct rlimit now;
  if (!getrlimit(RLIMIT_DATA, &now) && now.rlim_cur > most.rlim_cur) setrlimit(RLIMIT_DATA, &most);
  setrlimit(RLIMIT_FSIZE, &none);
#endif
}

/* With the flag, the kernel leaves out a defence against side channels that would slow the whole
 * process down; it is for those who run several parties' code in one process. */
static bool install(const struct sock_fprog *filter) {
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)) return false;
  if (!syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_SPEC_ALLOW, filter))
    return true;
  return !prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, filter, 0, 0);
}

bool vs_sandbox_process(vs_sandbox level) {
  program p = {.count = 0};
  if (level == VS_SANDBOX_TRIAL) limit_memory();
  if (!MACHINE) return false;
  write_program(&p, level);
  const struct sock_fprog filter = {p.count, p.step};
  return install(&filter);
}

bool vs_sandbox_works(void) {
  const uint32_t action = SECCOMP_RET_ERRNO;
  return MACHINE && !syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action);
}
