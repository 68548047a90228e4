"""exploration"""
