package arm

import (
	"os"
	"syscall"
	"testing"
	"time"
)

func TestFatalParallelBefore(t *testing.T) {
	t.Parallel()
}

func TestFatalFirst(t *testing.T) {}

func TestFatalPanics(t *testing.T) {
	panic("the arm is " + "on fire") // line: panics
}

func TestFatalPanicsInSubtest(t *testing.T) {
	t.Run("hot", func(t *testing.T) {
		var joints []int
		_ = joints[len(joints)+3] // line: panicsInSubtest
	})
}

func TestFatalPanicsInGoroutine(t *testing.T) {
	go func() {
		panic("lost arm") // line: panicsInGoroutine
	}()
	time.Sleep(time.Minute)
}

func TestFatalCrashes(t *testing.T) {
	syscall.Kill(syscall.Getpid(), syscall.SIGKILL)
	time.Sleep(time.Minute)
}

func TestFatalExits(t *testing.T) {
	os.Exit(0) // line: exits
}

// The process ends in it without a word.
func TestFatalExitsWithCode(t *testing.T) {
	os.Exit(3)
}

// The runtime finds it, as `go test` has no timer.
func TestFatalDeadlocks(t *testing.T) {
	<-make(chan bool)
}

func TestFatalHangs(t *testing.T) {
	waitForRobot()
}

func TestFatalLast(t *testing.T) {}

func waitForRobot() {
	time.Sleep(1000 * time.Hour)
}
