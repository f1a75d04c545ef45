// Command telemetry reads a trace with the decoder of the OpenTelemetry collector, and prints one line
// per span: its parent's name, its name, its status, and its number of events.
//
//	telemetry TRACE
package main

import (
	"fmt"
	"os"

	"go.opentelemetry.io/collector/pdata/pcommon"
	"go.opentelemetry.io/collector/pdata/ptrace"
)

func main() {
	if err := run(os.Args[1]); err != nil {
		fmt.Fprintln(os.Stderr, "error:", err)
		os.Exit(1)
	}
}

func run(path string) error {
	data, err := os.ReadFile(path)
	if err != nil {
		return err
	}
	traces, err := (&ptrace.JSONUnmarshaler{}).UnmarshalTraces(data)
	if err != nil {
		return err
	}
	resource := traces.ResourceSpans().At(0)
	service, _ := resource.Resource().Attributes().Get("service.name")
	spans := resource.ScopeSpans().At(0).Spans()
	names := map[pcommon.SpanID]string{}
	for i := range spans.Len() {
		span := spans.At(i)
		if span.TraceID().IsEmpty() || span.SpanID().IsEmpty() {
			return fmt.Errorf("the span %q has an empty id", span.Name())
		}
		if _, found := names[span.SpanID()]; found {
			return fmt.Errorf("two spans have the id %s", span.SpanID())
		}
		names[span.SpanID()] = span.Name()
		parent, found := names[span.ParentSpanID()]
		if !found && !span.ParentSpanID().IsEmpty() {
			return fmt.Errorf("the span %q has an unknown parent", span.Name())
		}
		if !found {
			parent = service.Str()
		}
		fmt.Printf("%s > %s: %s, %d events, %s\n", parent, span.Name(), span.Status().Code(),
			span.Events().Len(), span.EndTimestamp().AsTime().Sub(span.StartTimestamp().AsTime()))
	}
	return nil
}
