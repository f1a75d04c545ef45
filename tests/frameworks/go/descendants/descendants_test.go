// Package descendants has tests that start processes, see tests/frameworks/descendants.
package descendants

import (
	"bytes"
	"flag"
	"fmt"
	"os"
	"os/exec"
	"path/filepath"
	"strings"
	"syscall"
	"testing"
)

// In the environment of a descendant: whether its tests `pass` or `fail`.
const role = "DESCENDANT_ROLE"

// The result of a test; in a descendant, all tests have the same one.
func check(t *testing.T, deed func() bool) {
	if result, isDescendant := os.LookupEnv(role); isDescendant {
		fmt.Println("a descendant prints")
		if result == "fail" {
			t.Error("as a descendant")
		}
	} else if !deed() {
		t.Error("the test does not hold")
	}
}

// Executes this program again with its arguments.
func execute(result string, environment []string) (string, int) {
	command := exec.Command("/proc/self/exe", os.Args[1:]...)
	command.Env = append(environment, role+"="+result)
	output, _ := command.CombinedOutput()
	return string(output), command.ProcessState.ExitCode()
}

func passes(environment []string) bool {
	_, code := execute("pass", environment)
	return code == 0
}

func TestExecutesItself(t *testing.T) {
	check(t, func() bool { return passes(os.Environ()) })
}

func TestExecutesItselfWithoutEnvironment(t *testing.T) {
	check(t, func() bool { return passes(nil) })
}

func TestNeedsADescendantThatFails(t *testing.T) {
	check(t, func() bool {
		_, code := execute("fail", os.Environ())
		return code == 0
	})
}

func TestExpectsADescendantThatFails(t *testing.T) {
	check(t, func() bool {
		_, code := execute("fail", os.Environ())
		return code == 1
	})
}

func TestReadsWhatADescendantPrints(t *testing.T) {
	check(t, func() bool {
		output, _ := execute("pass", os.Environ())
		return strings.Contains(output, "a descendant prints")
	})
}

// The report of the descendant is in a message of the test. With its marks for `go test -json`,
// that would take it for results of this program.
func TestLogsWhatADescendantPrints(t *testing.T) {
	check(t, func() bool {
		output, code := execute("fail", os.Environ())
		t.Log(strings.ReplaceAll(output, "\x16", ""))
		return code == 1
	})
}

func TestForksAndExecutesItself(t *testing.T) {
	check(t, func() bool {
		discarded, _ := os.OpenFile(os.DevNull, os.O_WRONLY, 0)
		defer discarded.Close()
		child, err := syscall.ForkExec("/proc/self/exe", os.Args, &syscall.ProcAttr{
			Env:   append(os.Environ(), role+"=pass"),
			Files: []uintptr{0, discarded.Fd(), discarded.Fd()},
		})
		var status syscall.WaitStatus
		if err == nil {
			_, err = syscall.Wait4(child, &status, 0, nil)
		}
		return err == nil && status.Exited() && status.ExitStatus() == 0
	})
}

func TestStartsAProcessThatAborts(t *testing.T) {
	check(t, func() bool {
		command := exec.Command("sh", "-c", "kill -ABRT $$")
		err, isExit := command.Run().(*exec.ExitError)
		return isExit && err.Sys().(syscall.WaitStatus).Signal() == syscall.SIGABRT
	})
}

const inner = `package inner
import "testing"
func TestInnerPasses(t *testing.T) {}
func TestInnerFails(t *testing.T) { t.Error("inside") }
`

// The results of the inner run are no results of this one.
func TestRunsGoInGo(t *testing.T) {
	check(t, func() bool {
		directory := t.TempDir()
		for name, text := range map[string]string{
			"go.mod": "module inner\n\ngo 1.20\n", "inner_test.go": inner,
		} {
			if os.WriteFile(filepath.Join(directory, name), []byte(text), 0o644) != nil {
				return false
			}
		}
		command := exec.Command("go", "test", "-v", ".")
		command.Dir = directory
		output, _ := command.CombinedOutput()
		return bytes.Contains(output, []byte("--- FAIL: TestInnerFails")) &&
			bytes.Contains(output, []byte("--- PASS: TestInnerPasses"))
	})
}

func TestRunsATestInATest(t *testing.T) {
	check(t, func() bool {
		results := []bool{}
		inside := func(passes bool) testing.InternalTest {
			return testing.InternalTest{Name: "TestInside", F: func(t *testing.T) {
				if !passes {
					t.Error("inside")
				}
			}}
		}
		// It prints to standard output.
		output := os.Stdout
		os.Stdout, _ = os.OpenFile(os.DevNull, os.O_WRONLY, 0)
		defer func() { os.Stdout = output }()
		selected := flag.Lookup("test.run").Value
		pattern := selected.String()
		defer selected.Set(pattern)
		selected.Set("TestInside")
		all := func(pattern, name string) (bool, error) { return true, nil }
		for _, passes := range []bool{true, false} {
			results = append(results, testing.RunTests(all, []testing.InternalTest{inside(passes)}))
		}
		return results[0] && !results[1]
	})
}

func TestPasses(t *testing.T) {
	check(t, func() bool { return true })
}

func TestFails(t *testing.T) {
	check(t, func() bool { return false })
}
