// Package promises has the cases of tests/frameworks/promises.json.
package promises

import (
	"os"
	"os/exec"
	"testing"
)

func TestFirst(t *testing.T) {}

func TestSecond(t *testing.T) {
	shell := exec.Command("sh", "-c", os.Getenv("PROMISE"))
	shell.Stdout, shell.Stderr = os.Stdout, os.Stderr
	if err := shell.Run(); err != nil {
		t.Error(err)
	}
}

func TestThird(t *testing.T) {
	if os.Getenv("MEASURES") != "" {
		t.Attr("force", "2.5")
	}
}
